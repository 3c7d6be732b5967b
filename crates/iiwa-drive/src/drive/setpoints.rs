//! The trajectory in hand, set-point by set-point.

use iiwa_fri::{CommandMode, Monitoring, Safety, SessionState};
use iiwa_kin::{Joints, Limits};
use iiwa_link::{
    START_TOLERANCE_RAD, TimedJoints,
    message::{Code, Figures, Refusal},
};

use super::clock::Tick;
use crate::{
    playback::{Motion, Playback, STOP_S},
    robot_program::RunId,
};

/// A trajectory, from where the robot really is: the difference fades within the first half second.
pub(super) struct Offset {
    trajectory: Box<TimedJoints>,
    difference_rad: Joints,
    /// How long the difference takes at full speed, in s. The trajectory falls back by so much meanwhile:
    /// both together are no faster than the trajectory alone.
    behind_s: f64,
}

/// How long it takes a difference at the start to fade, in s. Half a degree takes 2 % of the acceleration
/// limits then, and as much again by which the trajectory falls back.
const FADE_S: f64 = 0.5;

/// Less than this is not waited for, in rad.
const NO_OFFSET_RAD: f64 = 1e-5;

impl Offset {
    fn new(trajectory: Box<TimedJoints>, difference_rad: Joints, limits: &Limits) -> Self {
        let takes_s = |j: usize| difference_rad[j].abs() / limits.velocity_rad_s[j];
        let behind_s = (0..7).map(takes_s).fold(0.0, f64::max);
        Self { trajectory, difference_rad, behind_s }
    }
}

impl Motion for Offset {
    fn at(&self, t_s: f64) -> Joints {
        let x = (t_s / FADE_S).clamp(0.0, 1.0);
        let faded = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
        let mut q = self.trajectory.at(t_s - self.behind_s * faded);
        for (q, offset) in q.iter_mut().zip(&self.difference_rad) {
            *q += (1.0 - faded) * offset;
        }
        q
    }

    fn duration_s(&self) -> f64 {
        let fades = self.difference_rad.iter().any(|offset| offset.abs() > NO_OFFSET_RAD);
        (self.trajectory.duration_s() + self.behind_s).max(if fades { FADE_S } else { 0.0 })
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
        parameters: Parameters,
        /// How long the robot has had to get to the last set-point, in s.
        arriving_s: f64,
    },
    /// It has broken off, and the arm is brought to rest; with what it was, which is freed where time does
    /// not count.
    Ending(Over, Box<Task>),
}

/// How often a controller sends, and how often it expects an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Parameters {
    period_ms: u32,
    receive_multiplier: u32,
}

/// Longest time between messages over which the arm can be commanded, in ms: what KUKA says.
const LONGEST_PERIOD_MS: u32 = 10;

/// Longest time between answers, in ms. A joint gets from rest to a quarter of its speed within.
const LONGEST_STEP_MS: u32 = 50;

impl Parameters {
    pub(super) fn of(message: &Monitoring) -> Self {
        Self {
            period_ms: message.send_period_ms,
            receive_multiplier: message.receive_multiplier.max(1),
        }
    }

    /// Time from one expected answer to the next, in s: a set-point is for the end of it.
    pub(super) fn step_s(self) -> f64 {
        f64::from(self.period_ms.max(1)) * f64::from(self.receive_multiplier) * 1e-3
    }

    /// Whether the arm can be commanded so.
    fn check(self) -> Result<(), Refusal> {
        let Self { period_ms, receive_multiplier } = self;
        if !(1..=LONGEST_PERIOD_MS).contains(&period_ms) {
            let stated = match period_ms {
                0 => "does not say how often it sends".to_owned(),
                _ => format!("sends every {period_ms} ms"),
            };
            return Err(Refusal::robot(format!(
                "the controller {stated}; to command, open FRI with a send period of 1 to \
                 {LONGEST_PERIOD_MS} ms"
            )));
        }
        if period_ms.saturating_mul(receive_multiplier) > LONGEST_STEP_MS {
            return Err(Refusal::robot(format!(
                "the controller expects an answer every {receive_multiplier} messages of {period_ms} ms; \
                 to command, open FRI so that it is at least every {LONGEST_STEP_MS} ms"
            )));
        }
        Ok(())
    }
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

/// How long the robot may take to get there, in s.
const ARRIVES_WITHIN_S: f64 = 1.0;

impl Task {
    /// Whether the trajectory has begun.
    pub(super) fn moves(&self) -> bool {
        matches!(self, Self::Running { .. } | Self::Ending(..))
    }

    /// From now on slows down to a stop on the path.
    pub(super) fn stop(&mut self) {
        if let Self::Running { playback, .. } = self {
            playback.stop(STOP_S);
        }
    }

    /// Breaks off the trajectory that is running, or is waited for.
    pub(super) fn fail(&mut self, error: Refusal, t_s: f64) {
        let (run, start_s) = match self {
            Self::Nothing | Self::Ending(..) => return,
            Self::Waiting { run, .. } => (*run, t_s),
            Self::Running { run, start_s, .. } => (*run, *start_s),
        };
        let over = Over { run, start_s, end_s: t_s, error: Some(error) };
        let was = Box::new(std::mem::take(self));
        *self = Self::Ending(over, was);
    }

    /// How the trajectory has ended at `t_s`, if it has broken off, and what it was; it is forgotten.
    pub(super) fn take_ended(&mut self, t_s: f64) -> Option<(Over, Self)> {
        match std::mem::take(self) {
            Self::Ending(over, was) => Some((Over { end_s: t_s, ..over }, *was)),
            other => {
                *self = other;
                None
            }
        }
    }

    /// Goes on as far as this message goes: gives the set-point, and how the trajectory has ended when it
    /// has come to its end. One that breaks off is `Ending` afterwards. It begins with an answer that
    /// `is_due`.
    pub(super) fn advance(
        &mut self,
        message: &Monitoring,
        tick: &Tick,
        limits: &Limits,
        is_due: bool,
    ) -> (Option<Joints>, Option<Over>) {
        let commands = message.session == SessionState::CommandingActive && is_safe(message);
        if let Self::Waiting { run, trajectory, armed } = self {
            let run = *run;
            if !(commands && *armed) {
                *armed = !commands;
                return (None, None);
            }
            if !is_due {
                return (None, None);
            }
            match start(trajectory, message, limits) {
                Ok(mut playback) => {
                    let parameters = Parameters::of(message);
                    playback.advance(parameters.step_s());
                    let setpoint = playback.position();
                    let start_s = tick.t_s;
                    *self = Self::Running { run, playback, start_s, parameters, arriving_s: 0.0 };
                    return (Some(setpoint), None);
                }
                Err(error) => self.fail(error, tick.t_s),
            }
            return (None, None);
        }
        let Self::Running { run, playback, start_s, parameters, arriving_s } = self else {
            return (None, None);
        };
        if let Err(error) = goes_on(message, *parameters) {
            self.fail(error, tick.t_s);
            return (None, None);
        }
        let setpoint = playback.position();
        if playback.is_over() && tick.elapsed_s > 0.0 {
            *arriving_s += tick.elapsed_s;
            let (at_s, of_s) = (playback.at_s(), playback.duration_s());
            let error = match furthest(message, &setpoint) {
                Some(_) if *arriving_s <= ARRIVES_WITHIN_S => return (Some(setpoint), None),
                Some((j, off_rad)) => Some(Refusal::robot(format!(
                    "joint {} is still {} deg from the last set-point, {ARRIVES_WITHIN_S} s after it",
                    j + 1,
                    Figures(off_rad.to_degrees(), 3),
                ))),
                None => playback.is_cut_short().then(|| {
                    Refusal::robot(format!("stopped on request at {at_s:.2} of {of_s:.2} s"))
                }),
            };
            let over = Over { run: *run, start_s: *start_s, end_s: tick.t_s, error };
            return (Some(setpoint), Some(over));
        }
        // By the controller's clock: a lost message costs no time.
        playback.advance(tick.elapsed_s);
        (Some(playback.position()), None)
    }
}

/// The joint that is furthest from the last set-point, and by how much in rad, if it has not arrived.
fn furthest(message: &Monitoring, setpoint: &Joints) -> Option<(usize, f64)> {
    let at = message.commanded_rad?;
    (0..7)
        .map(|j| (j, (at[j] - setpoint[j]).abs()))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, off_rad)| *off_rad >= ARRIVED_RAD)
}

/// Whether no safety stop is on.
fn is_safe(message: &Monitoring) -> bool {
    message.safety.is_none_or(|safety| safety == Safety::Normal)
}

/// Whether a trajectory may go on with this message.
fn goes_on(message: &Monitoring, parameters: Parameters) -> Result<(), Refusal> {
    if message.session != SessionState::CommandingActive {
        return Err(Refusal::robot(format!(
            "FRI does not command any more: session {}, quality {}",
            message.session.name(),
            message.quality.name()
        )));
    }
    if !is_safe(message) {
        // The arm stands, or brakes: set-points that went on would run away from it.
        return Err(Refusal::robot("the robot's safety stop is on"));
    }
    if message.commanded_rad.is_none() {
        return Err(Refusal::robot("FRI does not say any more where the robot is"));
    }
    if Parameters::of(message) != parameters {
        return Err(Refusal::robot(format!(
            "FRI's send period changed from {} to {} ms or its receive multiplier from {} to {} in the \
             middle of the run",
            parameters.period_ms,
            message.send_period_ms,
            parameters.receive_multiplier,
            message.receive_multiplier
        )));
    }
    Ok(())
}

/// The trajectory from where the robot is. It has been checked before, but the robot may have moved since.
fn start(
    trajectory: &mut Box<TimedJoints>,
    message: &Monitoring,
    limits: &Limits,
) -> Result<Box<Playback<Offset>>, Refusal> {
    if message.command_mode.is_some_and(|mode| mode != CommandMode::Position) {
        return Err(Refusal::robot(
            "the robot program has opened FRI for something else than positions",
        ));
    }
    Parameters::of(message).check()?;
    let start = trajectory.at(0.0);
    let Some(robot) = message.commanded_rad else {
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
    let motion = Offset::new(std::mem::take(trajectory), offset_rad, limits);
    Ok(Box::new(Playback::new(motion)))
}

#[cfg(test)]
mod tests {
    use iiwa_kin::Robot;

    use super::*;

    const CYCLE_S: f64 = 0.005;

    /// The `cycle`-th message of a session that commands, with the robot at 0.
    fn message(cycle: u32) -> Monitoring {
        Monitoring {
            sequence: cycle,
            session: SessionState::CommandingActive,
            send_period_ms: 5,
            commanded_rad: Some([0.0; 7]),
            ..Monitoring::default()
        }
    }

    fn advance(task: &mut Task, message: &Monitoring, t_s: f64) -> (Option<Joints>, Option<Over>) {
        let tick = Tick { t_s, elapsed_s: CYCLE_S };
        let (setpoint, over) = task.advance(message, &tick, Robot::default().limits(), true);
        (setpoint, over.or_else(|| task.take_ended(t_s).map(|(over, _)| over)))
    }

    /// A trajectory of joint 1 at 0.1 rad/s, in its tenth cycle.
    fn running(points: u32) -> Task {
        let t_s: Vec<f64> = (0..points).map(|i| f64::from(i) * 0.01).collect();
        let joints_rad = t_s.iter().map(|t_s| [0.1 * t_s, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
        let trajectory = Box::new(TimedJoints { t_s, joints_rad });
        let mut task = Task::Waiting { run: 7, trajectory, armed: true };
        for cycle in 0..10 {
            let (setpoint, over) = advance(&mut task, &message(cycle), f64::from(cycle) * CYCLE_S);
            assert!(over.is_none() && setpoint.is_some());
        }
        task
    }

    fn assert_ends(message: &Monitoring, why: &str) {
        let mut task = running(1000);
        let (setpoint, over) = advance(&mut task, message, 10.0 * CYCLE_S);
        assert_eq!(setpoint, None);
        let over = over.unwrap();
        let said = over.error.unwrap().message;
        assert!(over.run == 7 && said.contains(why), "{said}");
    }

    #[test]
    fn nothing_goes_on_after_a_safety_stop_or_with_other_parameters() {
        let message = message(10);
        assert_ends(&Monitoring { safety: Some(Safety::Stop1), ..message.clone() }, "safety stop");
        assert_ends(&Monitoring { send_period_ms: 10, ..message.clone() }, "from 5 to 10 ms");
        assert_ends(&Monitoring { receive_multiplier: 2, ..message.clone() }, "from 1 to 2");
        let session = SessionState::MonitoringWait;
        assert_ends(&Monitoring { session, ..message.clone() }, "monitoring_wait");
        assert_ends(&Monitoring { commanded_rad: None, ..message }, "where the robot is");
    }

    #[test]
    fn nothing_begins_with_parameters_that_cannot_command() {
        for (period_ms, receive_multiplier, why) in [
            (0, 1, "does not say"),
            (11, 1, "every 11 ms"),
            (1_000_000, 1, "every 1000000 ms"),
            (10, 6, "every 6 messages"),
            (1, 51, "every 51 messages"),
            (10, u32::MAX, "every 4294967295 messages"),
        ] {
            let trajectory = TimedJoints { t_s: vec![0.0, 1.0], joints_rad: vec![[0.0; 7]; 2] };
            let mut task = Task::Waiting { run: 7, trajectory: Box::new(trajectory), armed: true };
            let opened = Monitoring { send_period_ms: period_ms, receive_multiplier, ..message(0) };
            let (setpoint, over) = advance(&mut task, &opened, 0.0);
            let said = over.unwrap().error.unwrap().message;
            assert!(setpoint.is_none() && said.contains(why), "{said}");
        }
    }

    #[test]
    fn nothing_begins_where_the_robot_is_not_seen() {
        for (commanded_rad, at) in [(None, 0.0), (Some([0.0; 7]), 0.5)] {
            let trajectory = TimedJoints { t_s: vec![0.0, 1.0], joints_rad: vec![[at; 7]; 2] };
            let mut task = Task::Waiting { run: 7, trajectory: Box::new(trajectory), armed: true };
            let (setpoint, over) =
                advance(&mut task, &Monitoring { commanded_rad, ..message(0) }, 0.0);
            assert!(setpoint.is_none() && over.unwrap().error.is_some());
        }
    }

    /// A robot that stays a thousandth of a radian off: stopped or not, the run has an end.
    #[test]
    fn an_arm_that_never_arrives_ends_the_run() {
        for stops in [false, true] {
            let mut task = running(20);
            if stops {
                task.stop();
            }
            let mut cycle = 10;
            let over = loop {
                let mut at = [0.0; 7];
                if let Task::Running { playback, .. } = &task {
                    at = playback.position();
                }
                at[2] += 0.001;
                let message = Monitoring { commanded_rad: Some(at), ..message(cycle) };
                if let (_, Some(over)) = advance(&mut task, &message, f64::from(cycle) * CYCLE_S) {
                    break over;
                }
                cycle += 1;
                assert!(cycle < 1000, "it never ends");
            };
            let said = over.error.unwrap().message;
            assert!(said.contains("joint 3 is still 0.057 deg"), "{said}");
        }
    }

    /// However large the difference at the start, with it the arm is no faster than without.
    #[test]
    fn a_difference_at_the_start_fades_within_the_limits() {
        let limits = *Robot::default().limits();
        let t_s: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.01).collect();
        // At full speed from the start: no check would take it, but here speeds add up.
        let q = |t_s: &f64| limits.velocity_rad_s.map(|speed| speed * t_s);
        let joints_rad: Vec<Joints> = t_s.iter().map(q).collect();
        let trajectory = TimedJoints { t_s, joints_rad };
        for sign in [-1.0, 1.0] {
            let offset_rad = [sign * START_TOLERANCE_RAD; 7];
            let motion = Offset::new(Box::new(trajectory.clone()), offset_rad, &limits);
            for i in 5..100 {
                let [a, b, c] = [-1.0, 0.0, 1.0].map(|k| motion.at((f64::from(i) + k) * 0.01));
                for j in 0..7 {
                    let speed = (c[j] - b[j]) / 0.01 / limits.velocity_rad_s[j];
                    let bend = (c[j] - 2.0 * b[j] + a[j]) / 1e-4 / limits.acceleration_rad_s2[j];
                    assert!((0.9..1.0 + 1e-6).contains(&speed), "{speed}");
                    assert!(bend.abs() < 0.05, "{bend}");
                }
            }
            let end = motion.at(motion.duration_s() + 1e-9);
            assert_eq!(end, *trajectory.joints_rad.last().unwrap());
        }
    }
}
