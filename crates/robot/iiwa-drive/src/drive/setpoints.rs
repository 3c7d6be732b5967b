//! Set-points of the current trajectory.

use iiwa_fri::{CommandMode, Monitoring, Safety, SessionState};
use iiwa_kin::{Joints, Limits};
use iiwa_link::{
    START_TOLERANCE_RAD, TimedJoints,
    message::{Code, Figures, Refusal},
    robot_program::RunId,
};
use iiwa_traj::playback::{Playback, STOP_S, TimedMotion};

use super::clock::Tick;

/// A trajectory that starts at the robot's commanded position: the difference to its first point
/// fades within the first half second.
pub(super) struct OffsetTrajectory {
    trajectory: Box<TimedJoints>,
    difference_rad: Joints,
    /// Time that the difference takes at full speed, in s. The trajectory is delayed by this time
    /// while the difference fades, so that the sum is no faster than the trajectory alone.
    delay_s: f64,
}

/// Fading time of a difference at the start, in s. For half a degree, fading uses 2 % of the
/// acceleration limits, and the delay of the trajectory another 2 %.
const FADE_S: f64 = 0.5;

/// Largest difference for which a trajectory may be shorter than [`FADE_S`], in rad.
const NEGLIGIBLE_RAD: f64 = 1e-5;

impl OffsetTrajectory {
    fn new(trajectory: Box<TimedJoints>, difference_rad: Joints, limits: &Limits) -> Self {
        let takes_s = |j: usize| difference_rad[j].abs() / limits.velocity_rad_s[j];
        let delay_s = (0..7).map(takes_s).fold(0.0, f64::max);
        Self { trajectory, difference_rad, delay_s }
    }
}

impl TimedMotion for OffsetTrajectory {
    fn at(&self, t_s: f64) -> Joints {
        let x = (t_s / FADE_S).clamp(0.0, 1.0);
        // Quintic with zero velocity and acceleration at both ends.
        let faded = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
        let mut q = self.trajectory.at(t_s - self.delay_s * faded);
        for (q, offset) in q.iter_mut().zip(&self.difference_rad) {
            *q += (1.0 - faded) * offset;
        }
        q
    }

    fn duration_s(&self) -> f64 {
        let fades = self.difference_rad.iter().any(|offset| offset.abs() > NEGLIGIBLE_RAD);
        (self.trajectory.duration_s() + self.delay_s).max(if fades { FADE_S } else { 0.0 })
    }
}

/// The state of the current trajectory.
#[derive(Default)]
pub(super) enum TrajectoryTask {
    /// No trajectory.
    #[default]
    Idle,
    /// The trajectory waits until the FRI session is in the state `CommandingActive`.
    Pending {
        run: RunId,
        trajectory: Box<TimedJoints>,
        /// `true` once the session was outside `CommandingActive`, or in a safety stop, since this
        /// trajectory was received: the next commanding state then belongs to this trajectory and
        /// not to the previous one.
        armed: bool,
    },
    /// Set-points of the trajectory are being sent.
    Running {
        run: RunId,
        playback: Box<Playback<OffsetTrajectory>>,
        start_s: f64,
        parameters: SendParameters,
        /// Time spent waiting for arrival at the last set-point, in s.
        arriving_s: f64,
    },
    /// The trajectory was aborted or could not start; the robot is braking, or at rest. The
    /// previous state is kept, to be freed outside the real-time thread.
    Braking(TrajectoryEnd, Box<TrajectoryTask>),
}

/// Send period and receive multiplier of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SendParameters {
    period_ms: u32,
    receive_multiplier: u32,
}

/// Maximum time between messages for commanding, in ms, as specified by KUKA.
const LONGEST_PERIOD_MS: u32 = 10;

/// Maximum time between answers, in ms. A joint reaches a quarter of its velocity limit within this
/// time.
const LONGEST_STEP_MS: u32 = 50;

impl SendParameters {
    pub(super) fn of(message: &Monitoring) -> Self {
        Self {
            period_ms: message.send_period_ms,
            receive_multiplier: message.receive_multiplier.max(1),
        }
    }

    /// Returns the time between expected answers, in s: the horizon of a set-point.
    pub(super) fn step_s(self) -> f64 {
        f64::from(self.period_ms.max(1)) * f64::from(self.receive_multiplier) * 1e-3
    }

    /// Checks that the robot can be commanded with these parameters.
    pub(super) fn check(self) -> Result<(), Refusal> {
        let Self { period_ms, receive_multiplier } = self;
        if !(1..=LONGEST_PERIOD_MS).contains(&period_ms) {
            let stated = match period_ms {
                0 => "does not state its send period".to_owned(),
                _ => format!("sends every {period_ms} ms"),
            };
            return Err(Refusal::robot(format!(
                "the controller {stated}; to command, open FRI with a send period of 1 to \
                 {LONGEST_PERIOD_MS} ms"
            )));
        }
        if period_ms.saturating_mul(receive_multiplier) > LONGEST_STEP_MS {
            return Err(Refusal::robot(format!(
                "the controller expects an answer every {receive_multiplier} messages of \
                 {period_ms} ms; to command, open FRI so that it is at least every \
                 {LONGEST_STEP_MS} ms"
            )));
        }
        Ok(())
    }
}

/// The end of a trajectory, as seen by the drive.
pub(super) struct TrajectoryEnd {
    pub(super) run: RunId,
    /// Start on the stream time scale, in s.
    pub(super) start_s: f64,
    /// End on the stream time scale, in s.
    pub(super) end_s: f64,
    /// The reason for an abort or a stop, if the trajectory did not reach its end.
    pub(super) error: Option<Refusal>,
}

/// Arrival tolerance about the last set-point, in rad.
const ARRIVED_RAD: f64 = 1e-4;

/// Time-out of arrival at the last set-point, in s.
const ARRIVAL_TIMEOUT_S: f64 = 1.0;

impl TrajectoryTask {
    /// Returns true if the trajectory has begun, or was aborted and its end is not reported yet.
    pub(super) fn moves(&self) -> bool {
        matches!(self, Self::Running { .. } | Self::Braking(..))
    }

    /// Begins a stop on the path.
    pub(super) fn stop(&mut self) {
        if let Self::Running { playback, .. } = self {
            playback.stop(STOP_S);
        }
    }

    /// Aborts the trajectory.
    pub(super) fn fail(&mut self, error: Refusal, t_s: f64) {
        let (run, start_s) = match self {
            Self::Idle | Self::Braking(..) => return,
            Self::Pending { run, .. } => (*run, t_s),
            Self::Running { run, start_s, .. } => (*run, *start_s),
        };
        let end = TrajectoryEnd { run, start_s, end_s: t_s, error: Some(error) };
        let old = Box::new(std::mem::take(self));
        *self = Self::Braking(end, old);
    }

    /// Returns the end of an aborted trajectory at `t_s` and its previous state; the task is idle
    /// afterwards.
    pub(super) fn take_ended(&mut self, t_s: f64) -> Option<(TrajectoryEnd, Self)> {
        match std::mem::take(self) {
            Self::Braking(end, old) => Some((TrajectoryEnd { end_s: t_s, ..end }, *old)),
            other => {
                *self = other;
                None
            }
        }
    }

    /// Advances to the time of a message. Returns the set-point, in rad, and the end of the
    /// trajectory if it is complete. An aborted trajectory is `Braking` afterwards. `is_due`: the
    /// controller expects an answer to this message, to every `receive_multiplier`-th one. A
    /// trajectory begins only with such a message, because its first set-point is sent at once.
    pub(super) fn advance(
        &mut self,
        message: &Monitoring,
        tick: &Tick,
        limits: &Limits,
        is_due: bool,
    ) -> (Option<Joints>, Option<TrajectoryEnd>) {
        let commands = message.session == SessionState::CommandingActive && is_safe(message);
        if let Self::Pending { run, trajectory, armed } = self {
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
                    let parameters = SendParameters::of(message);
                    // The first set-point is one answer period ahead of the start.
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
        if let Err(error) = check_continuation(message, *parameters) {
            self.fail(error, tick.t_s);
            return (None, None);
        }
        let setpoint = playback.position();
        if playback.is_over() && tick.elapsed_s > 0.0 {
            *arriving_s += tick.elapsed_s;
            let (at_s, of_s) = (playback.at_s(), playback.duration_s());
            let error = match furthest(message, &setpoint) {
                Some(_) if *arriving_s <= ARRIVAL_TIMEOUT_S => return (Some(setpoint), None),
                Some((j, off_rad)) => Some(Refusal::robot(format!(
                    "joint A{} is still {} deg from the last set-point, {ARRIVAL_TIMEOUT_S} s \
                     after it",
                    j + 1,
                    Figures(off_rad.to_degrees(), 3),
                ))),
                None => playback.is_cut_short().then(|| {
                    Refusal::robot(format!("stopped on request at {at_s:.2} of {of_s:.2} s"))
                }),
            };
            let end = TrajectoryEnd { run: *run, start_s: *start_s, end_s: tick.t_s, error };
            return (Some(setpoint), Some(end));
        }
        // Time advances with the controller clock: a lost message does not delay the trajectory.
        playback.advance(tick.elapsed_s);
        (Some(playback.position()), None)
    }
}

/// Returns the joint (0 to 6) whose commanded position, as reported by the controller, is furthest
/// from the last set-point, and the distance in rad; `None` below [`ARRIVED_RAD`].
fn furthest(message: &Monitoring, setpoint: &Joints) -> Option<(usize, f64)> {
    let commanded = message.commanded_rad?;
    (0..7)
        .map(|j| (j, (commanded[j] - setpoint[j]).abs()))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, off_rad)| *off_rad >= ARRIVED_RAD)
}

/// Returns true if no safety stop is active.
fn is_safe(message: &Monitoring) -> bool {
    message.safety.is_none_or(|safety| safety == Safety::Normal)
}

/// Checks that a trajectory can continue with a message.
fn check_continuation(message: &Monitoring, parameters: SendParameters) -> Result<(), Refusal> {
    if message.session != SessionState::CommandingActive {
        return Err(Refusal::robot(format!(
            "FRI commanding has ended: session {}, quality {}",
            message.session.name(),
            message.quality.name()
        )));
    }
    if !is_safe(message) {
        // The robot is at rest or braking: further set-points would depart from it.
        return Err(Refusal::robot("a safety stop of the robot is active"));
    }
    if message.commanded_rad.is_none() {
        return Err(Refusal::robot("the FRI messages no longer contain the commanded position"));
    }
    if SendParameters::of(message) != parameters {
        return Err(Refusal::robot(format!(
            "FRI's send period changed from {} to {} ms or its receive multiplier from {} to {} \
             during the run",
            parameters.period_ms,
            message.send_period_ms,
            parameters.receive_multiplier,
            message.receive_multiplier
        )));
    }
    Ok(())
}

/// Starts the trajectory at the robot's commanded position. The robot may have moved since the
/// check.
fn start(
    trajectory: &mut Box<TimedJoints>,
    message: &Monitoring,
    limits: &Limits,
) -> Result<Box<Playback<OffsetTrajectory>>, Refusal> {
    if message.command_mode.is_some_and(|mode| mode != CommandMode::Position) {
        return Err(Refusal::robot(
            "the robot program has opened FRI for a command mode other than position",
        ));
    }
    SendParameters::of(message).check()?;
    let start = trajectory.at(0.0);
    let Some(robot) = message.commanded_rad else {
        return Err(Refusal::robot("the FRI messages do not contain the commanded position"));
    };
    let offset_rad: Joints = std::array::from_fn(|j| robot[j] - start[j]);
    if let Some(j) = (0..7).find(|&j| offset_rad[j].abs() > START_TOLERANCE_RAD) {
        return Err(Refusal::new(
            Code::StartMismatch,
            format!(
                "joint A{} has moved by {:.3} deg since the trajectory was checked",
                j + 1,
                offset_rad[j].to_degrees()
            ),
        ));
    }
    let motion = OffsetTrajectory::new(std::mem::take(trajectory), offset_rad, limits);
    Ok(Box::new(Playback::new(motion)))
}

#[cfg(test)]
mod tests {
    use iiwa_kin::Robot;

    use super::*;

    const CYCLE_S: f64 = 0.005;

    /// Returns the `cycle`-th message of a commanding session, with the robot at 0.
    fn message(cycle: u32) -> Monitoring {
        Monitoring {
            sequence: cycle,
            session: SessionState::CommandingActive,
            send_period_ms: 5,
            commanded_rad: Some([0.0; 7]),
            ..Monitoring::default()
        }
    }

    fn advance(
        task: &mut TrajectoryTask,
        message: &Monitoring,
        t_s: f64,
    ) -> (Option<Joints>, Option<TrajectoryEnd>) {
        let tick = Tick { t_s, elapsed_s: CYCLE_S };
        let (setpoint, end) = task.advance(message, &tick, Robot::default().limits(), true);
        (setpoint, end.or_else(|| task.take_ended(t_s).map(|(end, _)| end)))
    }

    /// Returns a trajectory of joint 1 at 0.1 rad/s, in its tenth cycle.
    fn running(points: u32) -> TrajectoryTask {
        let t_s: Vec<f64> = (0..points).map(|i| f64::from(i) * 0.01).collect();
        let joints_rad = t_s.iter().map(|t_s| [0.1 * t_s, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
        let trajectory = Box::new(TimedJoints { t_s, joints_rad });
        let mut task = TrajectoryTask::Pending { run: 7, trajectory, armed: true };
        for cycle in 0..10 {
            let (setpoint, end) = advance(&mut task, &message(cycle), f64::from(cycle) * CYCLE_S);
            assert!(end.is_none() && setpoint.is_some());
        }
        task
    }

    fn assert_ends(message: &Monitoring, reason: &str) {
        let mut task = running(1000);
        let (setpoint, end) = advance(&mut task, message, 10.0 * CYCLE_S);
        assert_eq!(setpoint, None);
        let end = end.unwrap();
        let text = end.error.unwrap().message;
        assert!(end.run == 7 && text.contains(reason), "{text}");
    }

    #[test]
    fn a_run_ends_with_a_safety_stop_or_changed_parameters() {
        let message = message(10);
        assert_ends(&Monitoring { safety: Some(Safety::Stop1), ..message.clone() }, "safety stop");
        assert_ends(&Monitoring { send_period_ms: 10, ..message.clone() }, "from 5 to 10 ms");
        assert_ends(&Monitoring { receive_multiplier: 2, ..message.clone() }, "from 1 to 2");
        let session = SessionState::MonitoringWait;
        assert_ends(&Monitoring { session, ..message.clone() }, "monitoring_wait");
        assert_ends(&Monitoring { commanded_rad: None, ..message }, "commanded position");
    }

    #[test]
    fn a_run_does_not_begin_with_unsuitable_parameters() {
        for (period_ms, receive_multiplier, reason) in [
            (0, 1, "does not state"),
            (11, 1, "every 11 ms"),
            (1_000_000, 1, "every 1000000 ms"),
            (10, 6, "every 6 messages"),
            (1, 51, "every 51 messages"),
            (10, u32::MAX, "every 4294967295 messages"),
        ] {
            let trajectory = TimedJoints { t_s: vec![0.0, 1.0], joints_rad: vec![[0.0; 7]; 2] };
            let mut task =
                TrajectoryTask::Pending { run: 7, trajectory: Box::new(trajectory), armed: true };
            let opened = Monitoring { send_period_ms: period_ms, receive_multiplier, ..message(0) };
            let (setpoint, end) = advance(&mut task, &opened, 0.0);
            let text = end.unwrap().error.unwrap().message;
            assert!(setpoint.is_none() && text.contains(reason), "{text}");
        }
    }

    #[test]
    fn a_run_does_not_begin_at_an_unknown_or_wrong_position() {
        for (commanded_rad, angle) in [(None, 0.0), (Some([0.0; 7]), 0.5)] {
            let trajectory = TimedJoints { t_s: vec![0.0, 1.0], joints_rad: vec![[angle; 7]; 2] };
            let mut task =
                TrajectoryTask::Pending { run: 7, trajectory: Box::new(trajectory), armed: true };
            let (setpoint, end) =
                advance(&mut task, &Monitoring { commanded_rad, ..message(0) }, 0.0);
            assert!(setpoint.is_none() && end.unwrap().error.is_some());
        }
    }

    /// A robot that remains 0.001 rad off ends the run, with and without a stop.
    #[test]
    fn an_arm_that_does_not_arrive_ends_the_run() {
        for stops in [false, true] {
            let mut task = running(20);
            if stops {
                task.stop();
            }
            let mut cycle = 10;
            let end = loop {
                let mut position = [0.0; 7];
                if let TrajectoryTask::Running { playback, .. } = &task {
                    position = playback.position();
                }
                position[2] += 0.001;
                let message = Monitoring { commanded_rad: Some(position), ..message(cycle) };
                if let (_, Some(end)) = advance(&mut task, &message, f64::from(cycle) * CYCLE_S) {
                    break end;
                }
                cycle += 1;
                assert!(cycle < 1000, "it never ends");
            };
            let text = end.error.unwrap().message;
            assert!(text.contains("joint A3 is still 0.057 deg"), "{text}");
        }
    }

    /// A difference at the start does not increase the speed.
    #[test]
    fn a_difference_at_the_start_fades_within_the_limits() {
        let limits = *Robot::default().limits();
        let t_s: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.01).collect();
        // At full speed from the start: not a valid trajectory, but the worst case here.
        let q = |t_s: &f64| limits.velocity_rad_s.map(|speed| speed * t_s);
        let joints_rad: Vec<Joints> = t_s.iter().map(q).collect();
        let trajectory = TimedJoints { t_s, joints_rad };
        for sign in [-1.0, 1.0] {
            let offset_rad = [sign * START_TOLERANCE_RAD; 7];
            let motion = OffsetTrajectory::new(Box::new(trajectory.clone()), offset_rad, &limits);
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
