//! A run: its requester, its measurements and its end.

use std::time::{Duration, Instant};

use iiwa_link::{
    message::{DriveState, MAX_SAMPLES, MeasuredPositions, Refusal, Run, RunLabel, TimedBy},
    robot_program::{Instruction, Outcome, RunId},
};

use super::{commanded_times::CommandedTimes, events::Observation, setpoints::TrajectoryEnd};

/// A run in progress. `A` is its requester.
pub(super) struct ActiveRun<A> {
    pub(super) kind: DriveState,
    pub(super) run: RunId,
    /// Label from the client request.
    pub(super) label: RunLabel,
    pub(super) requester: A,
    pub(super) phase: RunProgress,
    /// The instruction that ends the run; it is repeated until the run has ended.
    pub(super) end_instruction: Option<Instruction>,
    samples: MeasuredPositions,
    samples_left_out: u64,
    commanded: CommandedTimes,
    /// Time at which the robot program acknowledged the beginning of the run.
    begun_at: Option<Instant>,
    /// End of the trajectory on the drive side.
    pub(super) trajectory_end: Option<TrajectoryEnd>,
    /// End of the run, and the time until which its last samples are awaited.
    ended: Option<(EndedRun, Instant)>,
}

/// The phase of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RunProgress {
    /// The robot program plans the motions of the run; they can be withdrawn.
    Planning,
    /// The robot program is instructed to begin.
    Beginning,
    /// The run has begun.
    Begun,
}

#[derive(Default)]
struct EndedRun {
    start_s: Option<f64>,
    end_s: Option<f64>,
    /// Time since which messages are awaited that show the end, if the robot program reported no
    /// times.
    untimed: Option<Instant>,
    error: Option<Refusal>,
}

/// A finished run.
pub(super) struct FinishedRun<A> {
    pub(super) run: Run,
    pub(super) error: Option<Refusal>,
    /// `true` if the robot program had begun the run.
    pub(super) has_begun: bool,
    pub(super) requester: A,
}

/// Time-out of the robot program to report a run that it has acknowledged.
const REPORT_TIMEOUT: Duration = Duration::from_secs(2);

/// Time-out of the last samples of a run.
const SAMPLES_TIMEOUT: Duration = Duration::from_millis(100);

/// Time-out of the end of the commanded motion, and number of messages without change that confirm
/// the end.
const COMMANDED_TIMEOUT: Duration = Duration::from_secs(1);
const COMMANDED_MESSAGES: u32 = 3;

/// Time after the end of the commanded motion for which samples are kept, in s: the robot arrives
/// later.
const ARRIVAL_S: f64 = 0.25;

impl<A> ActiveRun<A> {
    pub(super) fn new(
        kind: DriveState,
        phase: RunProgress,
        run: RunId,
        label: RunLabel,
        requester: A,
        observation: Option<&Observation>,
    ) -> Self {
        let mut running = Self {
            kind,
            run,
            label,
            requester,
            phase,
            end_instruction: None,
            samples: MeasuredPositions::default(),
            samples_left_out: 0,
            commanded: CommandedTimes::default(),
            begun_at: None,
            trajectory_end: None,
            ended: None,
        };
        // The motion may begin before the next message arrives.
        if let Some(observation) = observation {
            running.record(observation);
        }
        running
    }

    /// Stores a sample.
    pub(super) fn record(&mut self, observation: &Observation) {
        self.commanded.observe(observation);
        if self.samples.t_s.len() < MAX_SAMPLES {
            self.samples.t_s.push(observation.t_s);
            self.samples.joints_rad.push(observation.joints_rad);
        } else {
            self.samples_left_out += 1;
        }
    }

    /// Records that the robot program has begun the run.
    pub(super) fn begun(&mut self, now: Instant) {
        self.phase = RunProgress::Begun;
        // The first time counts: the outcome calls this function again.
        self.begun_at.get_or_insert(now);
    }

    /// Returns true if the robot program should have reported the run by now.
    pub(super) fn is_overdue(&self, now: Instant) -> bool {
        self.begun_at
            .is_some_and(|begun_at| now.saturating_duration_since(begun_at) > REPORT_TIMEOUT)
    }

    /// Records that the robot program has ended the run; its clock is `ahead_s` ahead of the stream
    /// time.
    pub(super) fn end(&mut self, outcome: &Outcome, ahead_s: f64, now: Instant) {
        self.begun(now);
        if self.ended.is_some() {
            return;
        }
        let ended = match self.trajectory_end.take() {
            // The set-point times are known here.
            Some(TrajectoryEnd { start_s, end_s, error, .. }) if outcome.error.is_none() => {
                EndedRun { start_s: Some(start_s), end_s: Some(end_s), untimed: None, error }
            }
            trajectory_end => EndedRun {
                start_s: outcome.start_s.map(|start_s| start_s - ahead_s),
                end_s: outcome.end_s.map(|end_s| end_s - ahead_s),
                untimed: outcome.end_s.is_none().then_some(now),
                error: outcome
                    .error
                    .clone()
                    .or(trajectory_end.and_then(|trajectory_end| trajectory_end.error)),
            },
        };
        let timeout = match ended.untimed {
            Some(_) => COMMANDED_TIMEOUT,
            None => SAMPLES_TIMEOUT,
        };
        self.ended = Some((ended, now + timeout));
    }

    /// Records a failure of the run, which may not have begun.
    pub(super) fn fail(&mut self, error: Refusal, now: Instant) {
        self.ended.get_or_insert((EndedRun { error: Some(error), ..EndedRun::default() }, now));
    }

    /// Returns true if the run has ended.
    pub(super) fn has_ended(&self) -> bool {
        self.ended.is_some()
    }

    /// Returns true if the run has ended and its last samples have arrived or are no longer
    /// awaited.
    pub(super) fn is_complete(&self, observation: Option<&Observation>, now: Instant) -> bool {
        self.ended.as_ref().is_some_and(|(ended, until)| {
            let has_arrived = match (ended.untimed, ended.end_s) {
                // Messages that arrived before the outcome may be older than the end.
                (Some(since), _) => {
                    self.commanded.is_unchanged_for(COMMANDED_MESSAGES)
                        && observation.is_some_and(|it| it.at > since)
                }
                (None, Some(end_s)) => observation.is_some_and(|it| it.t_s >= end_s),
                (None, None) => true,
            };
            now >= *until || has_arrived
        })
    }

    /// Finishes the run.
    pub(super) fn finish(self) -> FinishedRun<A> {
        let (ended, _) = self.ended.unzip();
        let EndedRun { mut start_s, mut end_s, untimed, error } = ended.unwrap_or_default();
        let mut samples = self.samples;
        let mut run = Run::default();
        match untimed.map(|_| self.commanded.times_s()) {
            None => truncate(&mut samples, end_s),
            Some(Ok([from_s, to_s])) => {
                (start_s, end_s) = (Some(from_s), Some(to_s));
                run.timed_by = Some(TimedBy::CommandedPosition);
                truncate(&mut samples, Some(to_s + ARRIVAL_S));
            }
            Some(Err(reason)) => {
                start_s = None;
                run.untimed_because = error.is_none().then(|| reason.to_owned());
            }
        }
        run.samples = samples;
        run.cycle_time_s = start_s.zip(end_s).map(|(start, end)| end - start);
        run.start_s = start_s;
        run.samples_left_out = self.samples_left_out;
        FinishedRun { run, error, has_begun: self.begun_at.is_some(), requester: self.requester }
    }
}

/// Removes the samples after the end.
fn truncate(samples: &mut MeasuredPositions, end_s: Option<f64>) {
    // Stamps are sums: the last one may be slightly off.
    const ROUNDING_S: f64 = 1e-6;
    if let Some(end_s) = end_s {
        let count = samples.t_s.partition_point(|t_s| *t_s <= end_s + ROUNDING_S);
        samples.t_s.truncate(count);
        samples.joints_rad.truncate(count);
    }
}
