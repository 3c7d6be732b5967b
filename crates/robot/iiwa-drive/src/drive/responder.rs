//! The drive side of FRI, sans I/O: input are controller datagrams, output are answers and events.

use std::{
    net::{IpAddr, SocketAddr},
    time::{Duration, Instant},
};

use iiwa_fri::{Format, FriClient, Monitoring, SessionState};
use iiwa_kin::{Joints, Limits};
use iiwa_link::{
    TimedJoints,
    message::{Figures, Refusal},
    robot_program::RunId,
};

use super::{
    clock::{Clock, Tick},
    events::{FriEvent, Observation},
    governor::Governor,
    plausibility::{MessageVerdict, Plausibility},
    setpoints::{SendParameters, TrajectoryTask},
};

/// Result of receiving a datagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reception {
    /// The datagram is invalid, implausible or not newer than the latest message.
    Ignored,
    /// The message is accepted, and no answer is due.
    Accepted,
    /// The message is accepted and answered.
    Answered,
}

/// The drive side of FRI.
pub(super) struct Responder {
    limits: Limits,
    client: FriClient,
    plausibility: Plausibility,
    clock: Clock,
    task: TrajectoryTask,
    governor: Governor,
    measured_rad: Option<Joints>,
    /// Arrival time of the current trajectory, or of the last message while the trajectory runs.
    busy_since: Option<Instant>,
    events: Vec<FriEvent>,
}

/// Time-out of controller messages while a trajectory runs.
const SILENCE_TIMEOUT: Duration = Duration::from_secs(1);

/// Time-out of a session to reach active commanding.
const COMMANDING_TIMEOUT: Duration = Duration::from_secs(30);

impl Responder {
    /// Creates a responder that accepts messages from `cabinet` only.
    pub(super) fn new(cabinet: IpAddr, limits: &Limits) -> Self {
        Self {
            limits: *limits,
            client: FriClient::new(Format::V1),
            plausibility: Plausibility::new(cabinet, limits),
            clock: Clock::default(),
            task: TrajectoryTask::Idle,
            governor: Governor::new(limits),
            measured_rad: None,
            busy_since: None,
            events: Vec::new(),
        }
    }

    /// Drains the events since the last call.
    pub(super) fn take_events(&mut self) -> impl Iterator<Item = FriEvent> + '_ {
        // `drain` keeps the capacity: the real-time thread does not allocate again.
        self.events.drain(..)
    }

    /// Returns the stream time of the last message, in s.
    pub(super) fn time_s(&self) -> f64 {
        self.clock.last_s
    }

    /// Returns true if a trajectory has begun and set-points may move the robot.
    pub(super) fn moves(&self) -> bool {
        self.task.moves()
    }

    /// Returns the number of implausible messages.
    pub(super) fn ignored(&self) -> u64 {
        self.plausibility.ignored()
    }

    /// Runs a trajectory once the session commands.
    pub(super) fn run(&mut self, run: RunId, trajectory: Box<TimedJoints>, now: Instant) {
        self.busy_since = Some(now);
        self.replace(TrajectoryTask::Pending { run, trajectory, armed: false });
    }

    /// Stops the trajectory on its path. A trajectory that has not begun is discarded, with an
    /// event if `report`.
    pub(super) fn stop(&mut self, report: bool) {
        if self.task.moves() {
            return self.task.stop();
        }
        if report {
            self.events.push(FriEvent::Discarded);
        }
        self.replace(TrajectoryTask::Idle);
    }

    fn replace(&mut self, next: TrajectoryTask) {
        let old = std::mem::replace(&mut self.task, next);
        // The dispatcher frees the task: freeing may take longer than a cycle permits.
        self.events.push(FriEvent::Freed(old));
    }

    /// Receives a datagram that has arrived at `now`, and encodes the answer into `answer`, whose
    /// content is replaced.
    pub(super) fn receive(
        &mut self,
        datagram: &[u8],
        from: SocketAddr,
        now: Instant,
        answer: &mut Vec<u8>,
    ) -> Reception {
        answer.clear();
        let message = match self.client.decode(datagram) {
            Ok(message) => message,
            Err(error) => {
                tracing::debug!("FRI: {error}");
                return Reception::Ignored;
            }
        };
        match self.plausibility.judge(&message, from, now, &self.client) {
            MessageVerdict::Ignore => {
                let unexpected = self.plausibility.unexpected(from, now);
                self.events.extend(unexpected.map(FriEvent::Unexpected));
                return Reception::Ignored;
            }
            MessageVerdict::Accept => {
                if !self.client.accept(message).is_fresh() {
                    return Reception::Ignored;
                }
            }
            MessageVerdict::Restart => {
                self.client.restart(message);
                self.clock.restart();
                if self.task.moves() {
                    let error = "the controller restarted during the run";
                    self.task.fail(Refusal::robot(error), self.clock.last_s);
                }
            }
        }
        // Cloned, because the answer changes the client; a message has no heap memory.
        let Some(message) = self.client.latest().cloned() else { return Reception::Ignored };
        let tick = self.clock.tick(&message, now);
        let outcome = self.answer(&message, tick, answer);
        if self.task.moves() {
            self.busy_since = Some(now);
        }
        if let Some(joints_rad) = message.measured_rad.or(self.measured_rad) {
            self.measured_rad = Some(joints_rad);
            self.observe(&message, tick, joints_rad, now);
        }
        outcome
    }

    fn answer(&mut self, message: &Monitoring, tick: Tick, answer: &mut Vec<u8>) -> Reception {
        let step_s = SendParameters::of(message).step_s();
        let commands = message.session == SessionState::CommandingActive;
        let is_due = self.client.is_due();
        if commands {
            self.governor.observe(message.commanded_rad.as_ref(), tick.elapsed_s, step_s);
        } else {
            self.governor.release();
        }
        let (mut requested, end) = self.task.advance(message, &tick, &self.limits, is_due);
        if let Some((j, off_rad)) =
            requested.and_then(|requested| self.governor.jump(&requested, step_s))
        {
            let error = format!(
                "joint A{} is {} deg from its set-point: messages or answers were lost",
                j + 1,
                Figures(off_rad.to_degrees(), 2)
            );
            self.task.fail(Refusal::robot(error), tick.t_s);
            self.governor.restart(step_s);
            // From here on, the governor brakes.
            requested = None;
        }
        let is_answered = is_due && {
            // Only for due answers: the governor bounds the differences of answers that are sent.
            let limited = self.governor.command(requested.as_ref());
            if let Some((j, by_rad)) = limited.as_ref().and_then(|limited| limited.moved) {
                let error = format!(
                    "a set-point exceeded the limits of joint A{} by {} deg",
                    j + 1,
                    Figures(by_rad.to_degrees(), 3)
                );
                self.task.fail(Refusal::robot(error), tick.t_s);
            }
            self.client.answer(limited.map(|limited| limited.joints_rad).as_ref(), answer)
        };
        // All other work follows the answer.
        if let Some(end) = end {
            self.events.push(FriEvent::Ended(end));
            self.replace(TrajectoryTask::Idle);
        } else if !commands || self.governor.is_at_rest() {
            self.report_end(tick.t_s);
        }
        if is_answered { Reception::Answered } else { Reception::Accepted }
    }

    /// Reports the end of an aborted trajectory.
    fn report_end(&mut self, t_s: f64) {
        if let Some((end, old)) = self.task.take_ended(t_s) {
            self.events.push(FriEvent::Ended(end));
            self.events.push(FriEvent::Freed(old));
        }
    }

    /// Checks the time-outs at `now`.
    pub(super) fn check_timeouts(&mut self, now: Instant) {
        let Some(since) = self.busy_since else { return };
        let waited = now.saturating_duration_since(since);
        let error = match &self.task {
            TrajectoryTask::Pending { .. } if waited > COMMANDING_TIMEOUT => {
                format!(
                    "FRI did not reach active commanding within {} s",
                    COMMANDING_TIMEOUT.as_secs()
                )
            }
            TrajectoryTask::Running { .. } | TrajectoryTask::Braking(..)
                if waited > SILENCE_TIMEOUT =>
            {
                format!("no FRI message arrived for {} s during the run", SILENCE_TIMEOUT.as_secs())
            }
            _ => return,
        };
        self.task.fail(Refusal::robot(error), self.clock.last_s);
        // Without messages, a standstill cannot be observed: the end is reported at once.
        self.governor.release();
        self.report_end(self.clock.last_s);
    }

    fn observe(&mut self, message: &Monitoring, tick: Tick, joints_rad: Joints, now: Instant) {
        let counters = self.client.counters();
        self.events.push(FriEvent::Observed(Observation {
            t_s: tick.t_s,
            clock_ahead_s: self.clock.ahead_s,
            joints_rad,
            commanded_rad: message.commanded_rad,
            torques_nm: message
                .measured_torque_nm
                .zip(message.external_torque_nm)
                .map(|(measured, external)| [measured, external]),
            session: message.session,
            quality: message.quality,
            safety: message.safety.unwrap_or_default(),
            lost: counters.lost,
            late: counters.late,
            at: now,
        }));
    }
}
