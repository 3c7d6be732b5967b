//! The trajectory in hand, set-point by set-point.

use iiwa_kin::Joints;

use crate::{
    fri::{CommandMode, Monitoring, SessionState},
    message::{Code, Refusal},
    playback::{Motion, Playback, STOP_S},
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
        trajectory: Box<TimedJoints>,
        /// Since it was ordered, the session has been in another state: it commands for this trajectory,
        /// not for the one before.
        armed: bool,
    },
    Running {
        playback: Box<Playback<Offset>>,
        start_s: f64,
        /// Time of the last set-point.
        at_s: f64,
    },
}

/// How a trajectory has ended, on this side.
pub(super) struct Over {
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
        let commands = message.session == SessionState::CommandingActive;
        if let Self::Waiting { trajectory, armed } = self {
            if !(commands && *armed) {
                *armed = !commands;
                return (None, None);
            }
            return match start(trajectory, message) {
                Ok(mut playback) => {
                    playback.advance(cycle_s(message));
                    let setpoint = playback.position();
                    *self = Self::Running { playback, start_s: t_s, at_s: t_s };
                    (Some(setpoint), None)
                }
                Err(error) => (None, Some(Over { start_s: t_s, end_s: t_s, error: Some(error) })),
            };
        }
        let Self::Running { playback, start_s, at_s } = self else { return (None, None) };
        let over = |error| Over { start_s: *start_s, end_s: t_s, error };
        if !commands {
            let error = Refusal::robot(format!(
                "FRI does not command any more: session {}, quality {}",
                message.session.name(),
                message.quality.name()
            ));
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
        playback.advance((t_s - *at_s).max(0.0));
        *at_s = t_s;
        (Some(playback.position()), None)
    }
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
    let robot = message.ipo_rad.or(message.commanded_rad).or(message.measured_rad);
    let offset_rad: Joints =
        robot.map_or([0.0; 7], |robot| std::array::from_fn(|j| robot[j] - start[j]));
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
