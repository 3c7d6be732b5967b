//! A run: what was asked for, what was measured, and how it ended.

use std::time::{Duration, Instant};

use iiwa_link::message::{DriveState, MAX_SAMPLES, Refusal, Run, Samples};

use super::{fri::Heard, setpoints::Over};
use crate::robot_program::{Instruction, Outcome, RunId};

/// A run that has begun. `A` is who asked for it.
pub(super) struct Running<A> {
    pub(super) kind: DriveState,
    pub(super) run: RunId,
    pub(super) asked: A,
    pub(super) phase: Phase,
    /// How the robot program is told to end it, once it is: again, as long as it goes on.
    pub(super) ended_by: Option<Instruction>,
    samples: Samples,
    samples_left_out: u64,
    /// When the robot program has taken it.
    taken: Option<Instant>,
    /// How a trajectory went on this side.
    pub(super) commanded: Option<Over>,
    /// How it ended, and until when samples up to there are waited for.
    ended: Option<(Ended, Instant)>,
}

/// How far a run has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    /// The robot program plans its motions: they can be withdrawn.
    Planning,
    /// The robot program is told to begin.
    Beginning,
    /// It has.
    Begun,
}

#[derive(Default)]
struct Ended {
    start_s: Option<f64>,
    end_s: Option<f64>,
    error: Option<Refusal>,
}

/// What is left of a run.
pub(super) struct Left<A> {
    pub(super) run: Run,
    pub(super) error: Option<Refusal>,
    /// Whether it had come as far as to the robot program.
    pub(super) was_taken: bool,
    pub(super) asked: A,
}

/// How long the robot program may not yet know of a run that it has taken on.
const KNOWN_WITHIN: Duration = Duration::from_secs(2);

/// How long the last samples of a run are waited for.
const LAST_SAMPLES: Duration = Duration::from_millis(100);

impl<A> Running<A> {
    pub(super) fn new(
        kind: DriveState,
        phase: Phase,
        run: RunId,
        asked: A,
        heard: Option<&Heard>,
    ) -> Self {
        let mut running = Self {
            kind,
            run,
            asked,
            phase,
            ended_by: None,
            samples: Samples::default(),
            samples_left_out: 0,
            taken: None,
            commanded: None,
            ended: None,
        };
        // The motion may begin before the next message comes.
        if let Some(heard) = heard {
            running.keep(heard);
        }
        running
    }

    /// Keeps a sample.
    pub(super) fn keep(&mut self, heard: &Heard) {
        if self.samples.t_s.len() < MAX_SAMPLES {
            self.samples.t_s.push(heard.t_s);
            self.samples.joints_rad.push(heard.joints_rad);
        } else {
            self.samples_left_out += 1;
        }
    }

    /// The robot program has taken it on.
    pub(super) fn take(&mut self, now: Instant) {
        self.phase = Phase::Begun;
        self.taken.get_or_insert(now);
    }

    /// The robot program took it on, long enough ago to have said so in its states.
    pub(super) fn is_forgotten(&self, now: Instant) -> bool {
        self.taken.is_some_and(|taken| now.saturating_duration_since(taken) > KNOWN_WITHIN)
    }

    /// The robot program has ended the run; its clock is `ahead_s` ahead of the stream's.
    pub(super) fn end(&mut self, outcome: &Outcome, ahead_s: f64, now: Instant) {
        self.take(now);
        if self.ended.is_some() {
            return;
        }
        let ended = match self.commanded.take() {
            // This side knows best when the set-points began and ended.
            Some(Over { start_s, end_s, error, .. }) if outcome.error.is_none() => {
                Ended { start_s: Some(start_s), end_s: Some(end_s), error }
            }
            commanded => Ended {
                start_s: outcome.start_s.map(|start_s| start_s - ahead_s),
                end_s: Some(outcome.end_s - ahead_s),
                error: outcome.error.clone().or(commanded.and_then(|commanded| commanded.error)),
            },
        };
        self.ended = Some((ended, now + LAST_SAMPLES));
    }

    /// It has failed, or never begun.
    pub(super) fn fail(&mut self, error: Refusal, now: Instant) {
        self.ended.get_or_insert((Ended { error: Some(error), ..Ended::default() }, now));
    }

    /// Whether it has ended.
    pub(super) fn has_ended(&self) -> bool {
        self.ended.is_some()
    }

    /// Whether it has ended, and its last samples are there, or are waited for no longer.
    pub(super) fn is_complete(&self, heard: Option<&Heard>, now: Instant) -> bool {
        self.ended.as_ref().is_some_and(|(ended, until)| {
            let is_there = |end_s| heard.is_some_and(|heard| heard.t_s >= end_s);
            now >= *until || ended.end_s.is_none_or(is_there)
        })
    }

    /// What is left of it.
    pub(super) fn leave(self) -> Left<A> {
        let (ended, _) = self.ended.unzip();
        let Ended { start_s, end_s, error } = ended.unwrap_or_default();
        let mut samples = self.samples;
        cut(&mut samples, end_s);
        Left {
            run: Run {
                cycle_time_s: start_s.zip(end_s).map(|(start, end)| end - start),
                start_s,
                samples,
                samples_left_out: self.samples_left_out,
            },
            error,
            was_taken: self.taken.is_some(),
            asked: self.asked,
        }
    }
}

/// Leaves out what came after the end.
fn cut(samples: &mut Samples, end_s: Option<f64>) {
    // Stamps are sums: the last one may be a little off.
    const ROUNDING_S: f64 = 1e-6;
    if let Some(end_s) = end_s {
        let count = samples.t_s.partition_point(|t_s| *t_s <= end_s + ROUNDING_S);
        samples.t_s.truncate(count);
        samples.joints_rad.truncate(count);
    }
}
