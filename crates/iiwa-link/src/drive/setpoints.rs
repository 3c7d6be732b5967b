//! The trajectory in hand, set-point by set-point.

use iiwa_kin::Joints;

use crate::{
    fri::{CommandMode, Monitoring, Safety, SessionState, ahead},
    message::{Code, Refusal},
    playback::{Motion, Playback, STOP_S},
    robot_program::RunId,
    timed_joints::{START_TOLERANCE_RAD, TimedJoints},
};

/// A trajectory, from where the robot really is: the difference fades within the first half second.
pub(super) struct Offset {
    trajectory: Box<TimedJoints>,
    offset_rad: Joints,
}

/// How long it takes a difference at the start to fade, in s. Half a degree takes 2 % of the acceleration
/// limits then.
const FADE_S: f64 = 0.5;

/// Less than this is not waited for, in rad.
const NO_OFFSET_RAD: f64 = 1e-5;

impl Motion for Offset {
    fn at(&self, t_s: f64) -> Joints {
        let x = (t_s / FADE_S).clamp(0.0, 1.0);
        let left = 1.0 - x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
        let mut q = self.trajectory.at(t_s);
        for (q, offset) in q.iter_mut().zip(&self.offset_rad) {
            *q += left * offset;
        }
        q
    }

    fn duration_s(&self) -> f64 {
        let fades = self.offset_rad.iter().any(|offset| offset.abs() > NO_OFFSET_RAD);
        self.trajectory.duration_s().max(if fades { FADE_S } else { 0.0 })
    }
}

/// The trajectory in hand.
#[derive(Default)]
pub(super) enum Task {
    #[default]
    Nothing,
    /// Until the session commands.
    Waiting {
        run: RunId,
        trajectory: Box<TimedJoints>,
        /// Since it was ordered, the session has been in another state: it commands for this trajectory,
        /// not for the one before.
        armed: bool,
    },
    Running {
        run: RunId,
        playback: Box<Playback<Offset>>,
        start_s: f64,
        /// Time of the last set-point.
        at_s: f64,
        /// The counter of the message that it answered.
        sequence: u32,
    },
}

/// How a trajectory has ended, on this side.
pub(super) struct Over {
    pub(super) run: RunId,
    /// When it began, in s of the stream.
    pub(super) start_s: f64,
    /// When it ended, in s of the stream.
    pub(super) end_s: f64,
    /// Why it ended early.
    pub(super) error: Option<Refusal>,
}

/// As near as this the robot has got the last set-point, in rad.
const ARRIVED_RAD: f64 = 1e-4;

impl Task {
    /// Whether the trajectory has begun.
    pub(super) fn moves(&self) -> bool {
        matches!(self, Self::Running { .. })
    }

    /// From now on slows down to a stop on the path.
    pub(super) fn stop(&mut self) {
        if let Self::Running { playback, .. } = self {
            playback.stop(STOP_S);
        }
    }

    /// Goes on as far as this message goes: gives the set-point, and how the trajectory has ended when it
    /// has.
    pub(super) fn advance(
        &mut self,
        message: &Monitoring,
        t_s: f64,
    ) -> (Option<Joints>, Option<Over>) {
        let commands = message.session == SessionState::CommandingActive && is_safe(message);
        if let Self::Waiting { run, trajectory, armed } = self {
            let run = *run;
            if !(commands && *armed) {
                *armed = !commands;
                return (None, None);
            }
            return match start(trajectory, message) {
                Ok(mut playback) => {
                    playback.advance(cycle_s(message));
                    let setpoint = playback.position();
                    let sequence = message.sequence;
                    *self = Self::Running { run, playback, start_s: t_s, at_s: t_s, sequence };
                    (Some(setpoint), None)
                }
                Err(error) => {
                    (None, Some(Over { run, start_s: t_s, end_s: t_s, error: Some(error) }))
                }
            };
        }
        let Self::Running { run, playback, start_s, at_s, sequence } = self else {
            return (None, None);
        };
        let over = |error| Over { run: *run, start_s: *start_s, end_s: t_s, error };
        let cycles = ahead(message.sequence, *sequence);
        if let Some(error) = broken_off(message, cycles) {
            return (None, Some(over(Some(error))));
        }
        let setpoint = playback.position();
        let there = |q: Joints| (0..7).all(|j| (q[j] - setpoint[j]).abs() < ARRIVED_RAD);
        if playback.is_over() && t_s > *at_s && message.commanded_rad.is_none_or(there) {
            let error = playback.is_cut_short().then(|| {
                let (at_s, of_s) = (playback.at_s(), playback.duration_s());
                Refusal::robot(format!("stopped on request at {at_s:.2} of {of_s:.2} s"))
            });
            return (Some(setpoint), Some(over(error)));
        }
        // By the controller's clock: a lost message costs no time.
        playback.advance((t_s - *at_s).clamp(0.0, most_s(message, cycles)));
        (*at_s, *sequence) = (t_s, message.sequence);
        (Some(playback.position()), None)
    }
}

/// Whether no safety stop is on.
fn is_safe(message: &Monitoring) -> bool {
    message.safety.is_none_or(|safety| safety == Safety::Normal)
}

/// Why a trajectory must not go on with this message, which is so many cycles after the last one.
fn broken_off(message: &Monitoring, cycles: i32) -> Option<Refusal> {
    if message.session != SessionState::CommandingActive {
        return Some(Refusal::robot(format!(
            "FRI does not command any more: session {}, quality {}",
            message.session.name(),
            message.quality.name()
        )));
    }
    if !is_safe(message) {
        // The arm stands, or brakes: set-points that went on would run away from it.
        return Some(Refusal::robot("the robot's safety stop is on"));
    }
    (cycles <= 0)
        .then(|| Refusal::robot("the controller has started again in the middle of the run"))
}

/// The longest time, in s, that the controller's clock can have gone on within so many cycles. It may be
/// set while the arm moves: set-points must not leap with it.
fn most_s(message: &Monitoring, cycles: i32) -> f64 {
    if message.send_period_ms == 0 {
        return f64::INFINITY;
    }
    2.0 * f64::from(cycles) * f64::from(message.send_period_ms) * 1e-3
}

/// Time from one expected answer to the next, in s: a set-point is for the end of it.
fn cycle_s(message: &Monitoring) -> f64 {
    f64::from(message.send_period_ms.max(1) * message.receive_multiplier.max(1)) * 1e-3
}

/// The trajectory from where the robot is. It has been checked before, but the robot may have moved since.
fn start(
    trajectory: &mut Box<TimedJoints>,
    message: &Monitoring,
) -> Result<Box<Playback<Offset>>, Refusal> {
    if message.command_mode.is_some_and(|mode| mode != CommandMode::Position) {
        return Err(Refusal::robot(
            "the robot program has opened FRI for something else than positions",
        ));
    }
    let start = trajectory.at(0.0);
    let Some(robot) = message.ipo_rad.or(message.commanded_rad).or(message.measured_rad) else {
        return Err(Refusal::robot("FRI does not say where the robot is"));
    };
    let offset_rad: Joints = std::array::from_fn(|j| robot[j] - start[j]);
    if let Some(j) = (0..7).find(|&j| offset_rad[j].abs() > START_TOLERANCE_RAD) {
        return Err(Refusal::new(
            Code::StartMismatch,
            format!(
                "joint {} has moved by {:.3} deg since the trajectory was checked",
                j + 1,
                offset_rad[j].to_degrees()
            ),
        ));
    }
    Ok(Box::new(Playback::new(Offset { trajectory: std::mem::take(trajectory), offset_rad })))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE_S: f64 = 0.005;

    /// The `cycle`-th message of a session that commands, with the robot at 0.
    fn message(cycle: u32) -> Monitoring {
        Monitoring {
            sequence: cycle,
            session: SessionState::CommandingActive,
            send_period_ms: 5,
            ipo_rad: Some([0.0; 7]),
            ..Monitoring::default()
        }
    }

    /// A trajectory of joint 1 at 0.1 rad/s, in its tenth cycle.
    fn running() -> (Task, f64) {
        let t_s: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.01).collect();
        let joints_rad = t_s.iter().map(|t_s| [0.1 * t_s, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
        let trajectory = Box::new(TimedJoints { t_s, joints_rad });
        let mut task = Task::Waiting { run: 7, trajectory, armed: true };
        let mut last = 0.0;
        for cycle in 0..10 {
            let (setpoint, over) = task.advance(&message(cycle), f64::from(cycle) * CYCLE_S);
            assert!(over.is_none());
            last = setpoint.unwrap()[0];
        }
        (task, last)
    }

    #[test]
    fn a_clock_that_is_set_makes_no_leap() {
        let (mut task, before) = running();
        // Two messages are lost: their time is not.
        let (setpoint, _) = task.advance(&message(12), 12.0 * CYCLE_S);
        let after_loss = setpoint.unwrap()[0];
        assert!((after_loss - before - 0.1 * 3.0 * CYCLE_S).abs() < 1e-9);
        // The clock is an hour ahead, from one message to the next.
        let (setpoint, over) = task.advance(&message(13), 3600.0);
        assert!(over.is_none());
        assert!(setpoint.unwrap()[0] - after_loss <= 0.1 * 2.0 * CYCLE_S + 1e-9);
    }

    #[test]
    fn nothing_goes_on_after_a_safety_stop_or_a_restart() {
        let stopped = Monitoring { safety: Some(Safety::Stop1), ..message(10) };
        for (message, why) in [(stopped, "safety stop"), (message(3), "started again")] {
            let (mut task, _) = running();
            let (setpoint, over) = task.advance(&message, 10.0 * CYCLE_S);
            assert_eq!(setpoint, None);
            let over = over.unwrap();
            assert!(over.run == 7 && over.error.unwrap().message.contains(why));
        }
    }

    #[test]
    fn nothing_begins_where_the_robot_is_not_seen() {
        let trajectory = TimedJoints { t_s: vec![0.0, 1.0], joints_rad: vec![[0.5; 7]; 2] };
        let mut task = Task::Waiting { run: 7, trajectory: Box::new(trajectory), armed: true };
        let (setpoint, over) = task.advance(&Monitoring { ipo_rad: None, ..message(0) }, 0.0);
        assert!(setpoint.is_none() && over.unwrap().error.is_some());
    }
}
