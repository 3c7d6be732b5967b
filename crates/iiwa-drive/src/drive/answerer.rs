//! What the FRI thread does, without sockets, threads and clocks: datagrams of the controller come in;
//! answers and events go out.

use std::{
    net::{IpAddr, SocketAddr},
    time::{Duration, Instant},
};

use iiwa_fri::{Client, Format, Monitoring, Quality, Safety, SessionState};
use iiwa_kin::{Joints, Limits};
use iiwa_link::{
    TimedJoints,
    message::{DriveState, Figures, Refusal},
};

use super::{
    clock::{Clock, Tick},
    governor::Governor,
    plausibility::{Plausibility, Verdict},
    setpoints::{Over, Parameters, Task},
};
use crate::robot_program::RunId;

/// What the FRI thread is told.
pub(super) enum Order {
    /// Run this trajectory as soon as the session commands.
    Run(RunId, Box<TimedJoints>),
    /// Stop it on its path.
    Stop,
    /// Forget it; if the arm moves, only after a stop on its path.
    Release,
    /// Publish a state.
    Publish(DriveState),
}

/// What the FRI thread tells.
pub(super) enum Event {
    /// A message of the controller has come.
    Heard(Heard),
    /// The trajectory is over.
    Over(Over),
    /// The trajectory was to be stopped, and has not begun.
    Discarded,
    /// What is not needed any more: it is freed where time does not count.
    Freed(#[expect(dead_code, reason = "it is freed")] Task),
}

/// A message of the controller, with what it says of the connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heard {
    /// Time of the stream, in s.
    pub(super) t_s: f64,
    /// What the controller's clock says more than the stream's, in s.
    pub(super) clock_ahead_s: f64,
    pub(super) joints_rad: Joints,
    pub(super) session: SessionState,
    pub(super) quality: Quality,
    pub(super) safety: Safety,
    pub(super) lost: u64,
    pub(super) late: u64,
    pub(super) at: Instant,
}

/// What became of a datagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// It says nothing new, or does not fit the session.
    Nothing,
    /// It was a message, and no answer is due.
    Heard,
    /// It was a message, and this is the answer.
    Answered,
}

/// The drive's side of FRI.
pub(super) struct Answerer {
    limits: Limits,
    client: Client,
    plausibility: Plausibility,
    clock: Clock,
    task: Task,
    governor: Governor,
    measured_rad: Option<Joints>,
    /// When the last message came, or the trajectory in hand.
    busy_since: Option<Instant>,
    events: Vec<Event>,
}

/// How long the controller may keep silent, and a session take to command, while a trajectory is in hand.
const SILENT: Duration = Duration::from_secs(1);
const COMMANDS_WITHIN: Duration = Duration::from_secs(30);

impl Answerer {
    /// It listens to `cabinet` only.
    pub(super) fn new(cabinet: IpAddr, limits: &Limits) -> Self {
        Self {
            limits: *limits,
            client: Client::new(Format::V1),
            plausibility: Plausibility::new(cabinet, limits),
            clock: Clock::default(),
            task: Task::Nothing,
            governor: Governor::new(limits),
            measured_rad: None,
            busy_since: None,
            events: Vec::new(),
        }
    }

    /// What has happened since this was asked for.
    pub(super) fn take_events(&mut self) -> impl Iterator<Item = Event> + '_ {
        self.events.drain(..)
    }

    /// The stream's time of the last message, in s.
    pub(super) fn time_s(&self) -> f64 {
        self.clock.last_s
    }

    /// Whether the arm is moved by set-points.
    pub(super) fn moves(&self) -> bool {
        self.task.moves()
    }

    /// How many datagrams did not fit the session.
    pub(super) fn ignored(&self) -> u64 {
        self.plausibility.ignored()
    }

    /// Begins a trajectory as soon as the session commands.
    pub(super) fn run(&mut self, run: RunId, trajectory: Box<TimedJoints>, now: Instant) {
        self.busy_since = Some(now);
        self.replace(Task::Waiting { run, trajectory, armed: false });
    }

    /// Stops the trajectory on its path; one that has not begun is discarded, which is told if `tell`.
    pub(super) fn stop(&mut self, tell: bool) {
        if self.task.moves() {
            return self.task.stop();
        }
        if tell {
            self.events.push(Event::Discarded);
        }
        self.replace(Task::Nothing);
    }

    fn replace(&mut self, next: Task) {
        let was = std::mem::replace(&mut self.task, next);
        self.events.push(Event::Freed(was));
    }

    /// Takes a datagram that has come in at `now`, and writes the answer in place of what `answer` holds.
    pub(super) fn receive(
        &mut self,
        datagram: &[u8],
        from: SocketAddr,
        now: Instant,
        answer: &mut Vec<u8>,
    ) -> Outcome {
        answer.clear();
        let message = match self.client.read(datagram) {
            Ok(message) => message,
            Err(error) => {
                tracing::debug!("FRI: {error}");
                return Outcome::Nothing;
            }
        };
        match self.plausibility.judge(&message, from, now, &self.client) {
            Verdict::Ignore => return Outcome::Nothing,
            Verdict::Take => {
                if !self.client.take(message).is_fresh() {
                    return Outcome::Nothing;
                }
            }
            Verdict::Restart => {
                self.client.restart(message);
                self.clock.restart();
                if self.task.moves() {
                    let error = "the controller has started again in the middle of the run";
                    self.task.fail(Refusal::robot(error), self.clock.last_s);
                }
            }
        }
        // Cloned, as the answer changes the client; it holds no memory of its own.
        let Some(message) = self.client.latest().cloned() else { return Outcome::Nothing };
        let tick = self.clock.tick(&message, now);
        let outcome = self.answer(&message, tick, answer);
        if self.task.moves() {
            self.busy_since = Some(now);
        }
        if let Some(joints_rad) = message.measured_rad.or(self.measured_rad) {
            self.measured_rad = Some(joints_rad);
            self.tell(&message, tick, joints_rad, now);
        }
        outcome
    }

    fn answer(&mut self, message: &Monitoring, tick: Tick, answer: &mut Vec<u8>) -> Outcome {
        let step_s = Parameters::of(message).step_s();
        let commands = message.session == SessionState::CommandingActive;
        let is_due = self.client.is_due();
        if commands {
            self.governor.heard(message.commanded_rad.as_ref(), tick.elapsed_s, step_s);
        } else {
            self.governor.release();
        }
        let (mut wanted, over) = self.task.advance(message, &tick, &self.limits, is_due);
        if let Some((j, off_rad)) = wanted.and_then(|wanted| self.governor.leap(&wanted, step_s)) {
            let error = format!(
                "joint {} is {} deg from its set-point: messages or set-points got lost",
                j + 1,
                Figures(off_rad.to_degrees(), 2)
            );
            self.task.fail(Refusal::robot(error), tick.t_s);
            self.governor.begin_anew(step_s);
            wanted = None;
        }
        let is_answered = is_due && {
            let governed = self.governor.command(wanted.as_ref());
            if let Some((j, by_rad)) = governed.as_ref().and_then(|governed| governed.moved) {
                let error = format!(
                    "a set-point would have taken joint {} beyond its limits, by {} deg",
                    j + 1,
                    Figures(by_rad.to_degrees(), 3)
                );
                self.task.fail(Refusal::robot(error), tick.t_s);
            }
            self.client.answer(governed.map(|governed| governed.joints_rad).as_ref(), answer)
        };
        // All else comes after the answer.
        if let Some(over) = over {
            self.events.push(Event::Over(over));
            self.replace(Task::Nothing);
        } else if !commands || self.governor.is_at_rest() {
            self.end(tick.t_s);
        }
        if is_answered { Outcome::Answered } else { Outcome::Heard }
    }

    /// Tells how a trajectory that has broken off has ended.
    fn end(&mut self, t_s: f64) {
        if let Some((over, was)) = self.task.take_ended(t_s) {
            self.events.push(Event::Over(over));
            self.events.push(Event::Freed(was));
        }
    }

    /// Nothing has come in by `now`: every wait has an end.
    pub(super) fn wait(&mut self, now: Instant) {
        let Some(since) = self.busy_since else { return };
        let waited = now.saturating_duration_since(since);
        let error = match &self.task {
            Task::Waiting { .. } if waited > COMMANDS_WITHIN => {
                format!("FRI did not come to command within {} s", COMMANDS_WITHIN.as_secs())
            }
            Task::Running { .. } | Task::Ending(..) if waited > SILENT => {
                format!("FRI has been silent for {} s in the middle of the run", SILENT.as_secs())
            }
            _ => return,
        };
        self.task.fail(Refusal::robot(error), self.clock.last_s);
        self.governor.release();
        self.end(self.clock.last_s);
    }

    fn tell(&mut self, message: &Monitoring, tick: Tick, joints_rad: Joints, now: Instant) {
        let counters = self.client.counters();
        self.events.push(Event::Heard(Heard {
            t_s: tick.t_s,
            clock_ahead_s: self.clock.ahead_s,
            joints_rad,
            session: message.session,
            quality: message.quality,
            safety: message.safety.unwrap_or_default(),
            lost: counters.lost,
            late: counters.late,
            at: now,
        }));
    }
}
