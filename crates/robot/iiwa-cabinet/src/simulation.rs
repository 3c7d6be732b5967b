//! The simulated robot and robot program, sans I/O, advanced cycle by cycle.

#[cfg(test)]
mod tests;

use std::{collections::VecDeque, time::Duration};

use iiwa_fri::{Controller, ControllerConfig, Reading, Safety, SessionState, braking::fastest};
use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    message::{
        Code, Conditions, DriveState, Hello, IoValue, OperationMode, Refusal, RobotIdentity,
        Sensors,
    },
    robot_program::{Acknowledgement, Instruction, Outcome, PROTOCOL, RunId, StateChange},
};
use iiwa_path::JointPath;
use iiwa_program::MotionList;
use iiwa_traj::{
    Timing, Trajectory,
    playback::{EMERGENCY_STOP_S, Playback, STOP_S},
};

use crate::{
    io::Ports,
    position_sensors::PositionSensors,
    temperatures::Temperatures,
    torque_sensors::{JointMotion, TorqueReading, TorqueSensors},
};

/// Time-out of the controller for active commanding, in s.
const COMMANDING_TIMEOUT_S: f64 = 5.0;

/// Maximum send period for commanding, in s.
const MAX_COMMANDING_PERIOD_S: f64 = 0.010;

/// Permitted velocity of set-points, as a share of the limits, because clocks are inexact and
/// positions are rounded.
const SETPOINT_MARGIN: f64 = 1.1;

/// Deceleration of a joint before the end of its range, as a share of the acceleration limits.
const BRAKING_MARGIN: f64 = 1.25;

/// A robot, its controller and the robot program.
pub(crate) struct Simulation {
    robot: Robot,
    period_s: f64,
    receive_multiplier: u32,
    /// Cycles since the start: the controller clock.
    cycle: u64,
    /// Commanded joint positions, in rad.
    q: Joints,
    /// Commanded joint velocities, in rad/s.
    dq: Joints,
    /// Joint positions of the last cycles, in rad, the latest last: the positions within three
    /// set-points.
    trail: VecDeque<Joints>,
    activity: ProgramActivity,
    outcome: Option<Outcome>,
    boot: u64,
    fri: Controller,
    /// Cycle until which the emergency stop is pressed.
    pressed_until: Option<u64>,
    /// Share of the next motion after which the emergency stop is pressed.
    press_at: Option<f64>,
    pub(crate) position_sensors: PositionSensors,
    temperatures: Temperatures,
    pub(crate) torque_sensors: TorqueSensors,
    torques: TorqueReading,
    ports: Ports,
    /// `true` if outcomes have no times, and sensors no temperatures.
    without_times: bool,
    changed: bool,
}

/// Activity of the robot program.
enum ProgramActivity {
    Nothing,
    /// Executes planned motions.
    Motions {
        run: RunId,
        playback: Box<Playback<Trajectory>>,
        from: u64,
        error: Option<Refusal>,
    },
    /// Follows the set-points of the client.
    Commanded(Commanded),
    /// Brings the robot to rest, independent of any path.
    Braking(JointBraking),
}

struct Commanded {
    run: RunId,
    /// Cycle of the request.
    since: u64,
    /// Joint positions at the request, in rad.
    at_rad: Joints,
    /// Cycle in which commanding became active.
    from: Option<u64>,
    /// The last set-point, in rad, and the sequence counter of the message that it answers.
    last: Option<(Joints, u32)>,
    /// Number of cycles within which the robot has to reach the set-point.
    cycles_left: u32,
}

struct JointBraking {
    run: RunId,
    state: DriveState,
    from: Option<u64>,
    /// Initial positions, in rad, initial velocities, in rad/s, and braking times, in s, of the
    /// joints.
    began_rad: Joints,
    speed_rad_s: Joints,
    takes_s: Joints,
    for_s: f64,
    error: Refusal,
}

impl JointBraking {
    /// Returns the current joint positions, in rad: each joint brakes with constant deceleration.
    fn position(&self) -> Joints {
        std::array::from_fn(|j| {
            let t_s = self.for_s.min(self.takes_s[j]);
            let mean = if t_s > 0.0 { 1.0 - 0.5 * t_s / self.takes_s[j] } else { 0.0 };
            self.began_rad[j] + self.speed_rad_s[j] * mean * t_s
        })
    }

    fn joint_motion(&self) -> JointMotion {
        let moving = |j: usize, value: f64| if self.for_s < self.takes_s[j] { value } else { 0.0 };
        JointMotion {
            velocity_rad_s: std::array::from_fn(|j| {
                moving(j, self.speed_rad_s[j] * (1.0 - self.for_s / self.takes_s[j]))
            }),
            acceleration_rad_s2: std::array::from_fn(|j| {
                moving(j, -self.speed_rad_s[j] / self.takes_s[j])
            }),
        }
    }

    fn is_over(&self) -> bool {
        self.takes_s.iter().all(|takes_s| self.for_s >= *takes_s)
    }
}

impl Simulation {
    pub(crate) fn new(robot: Robot, start_rad: Joints, fri: ControllerConfig, boot: u64) -> Self {
        let torque_sensors = TorqueSensors::new(&robot, None, None, 0.0);
        Self {
            robot,
            period_s: f64::from(fri.period_ms) * 1e-3,
            receive_multiplier: fri.receive_multiplier,
            cycle: 0,
            q: start_rad,
            dq: [0.0; 7],
            trail: VecDeque::new(),
            activity: ProgramActivity::Nothing,
            outcome: None,
            boot,
            fri: Controller::new(fri),
            pressed_until: None,
            press_at: None,
            position_sensors: PositionSensors::ideal(),
            temperatures: Temperatures::new(),
            torque_sensors,
            torques: TorqueReading::default(),
            ports: Ports::default(),
            without_times: false,
            changed: true,
        }
    }

    /// Sets an input or output.
    pub(crate) fn set_signal(&mut self, name: &str, value: IoValue) -> Result<(), Refusal> {
        self.ports.assign(name, value).map(drop)
    }

    /// Omits the times of outcomes and the temperatures of sensors, like a real cabinet.
    pub(crate) fn leave_out_times(&mut self) {
        self.without_times = true;
    }

    /// Returns the controller time, in s.
    fn now_s(&self) -> f64 {
        self.at_s(self.cycle)
    }

    fn at_s(&self, cycle: u64) -> f64 {
        cycle as f64 * self.period_s
    }

    fn cycles(&self, seconds: f64) -> u64 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let cycles = (seconds / self.period_s).ceil() as u64;
        cycles
    }

    /// Returns the state as sent to iiwaDrive, if it has changed since the last call.
    pub(crate) fn take_change(&mut self) -> Option<StateChange> {
        std::mem::take(&mut self.changed).then(|| self.state())
    }

    /// Returns the state as sent to iiwaDrive.
    pub(crate) fn state(&self) -> StateChange {
        let (state, run) = match &self.activity {
            ProgramActivity::Nothing => (DriveState::Idle, None),
            ProgramActivity::Motions { run, .. } => (DriveState::RunningMotion, Some(*run)),
            ProgramActivity::Commanded(commanded) => {
                (DriveState::RunningTrajectory, Some(commanded.run))
            }
            ProgramActivity::Braking(braking) => (braking.state, Some(braking.run)),
        };
        let mut conditions = Conditions::default();
        conditions.operation_mode = Some(OperationMode::Aut);
        conditions.override_rel = Some(1.0);
        conditions.safety_stop = Some(self.pressed_until.is_some());
        let program = concat!("iiwasim cabinet ", env!("CARGO_PKG_VERSION"));
        let mut hello = Hello::new(PROTOCOL, program);
        hello.robot = Some(RobotIdentity::from(&self.robot));
        StateChange {
            boot: self.boot,
            state,
            run,
            outcome: self.outcome.clone(),
            simulated: true,
            hello: Some(hello),
            conditions: Some(conditions),
        }
    }

    /// Returns the current joint positions, in rad.
    pub(crate) fn position(&self) -> &Joints {
        &self.q
    }

    pub(crate) fn fri(&mut self) -> &mut Controller {
        &mut self.fri
    }

    /// Presses the emergency stop for a time, in s.
    pub(crate) fn press_emergency_stop(&mut self, seconds: f64) {
        self.pressed_until = Some(self.cycle + self.cycles(seconds));
        self.changed = true;
        let error = Refusal::robot("the emergency stop was pressed");
        match &mut self.activity {
            ProgramActivity::Nothing | ProgramActivity::Braking(_) => {}
            ProgramActivity::Motions { playback, error: stop_reason, .. } => {
                playback.stop(EMERGENCY_STOP_S);
                *stop_reason = Some(error);
            }
            ProgramActivity::Commanded(_) => self.brake(error),
        }
    }

    /// Presses the emergency stop at this share of the next motion.
    pub(crate) fn press_emergency_stop_at(&mut self, share: Option<f64>) {
        self.press_at = share;
    }

    /// Drops the FRI session for a number of seconds.
    pub(crate) fn drop_session(&mut self, seconds: f64) {
        self.fri.drop_session(self.cycles(seconds));
    }

    /// Advances by one cycle, and encodes the FRI message if one is due.
    pub(crate) fn tick(&mut self, message: &mut Vec<u8>) -> bool {
        self.cycle += 1;
        if self.pressed_until.is_some_and(|until| until <= self.cycle) {
            self.pressed_until = None;
            self.changed = true;
        }
        let before = self.q;
        self.fri.advance();
        self.advance();
        self.dq = std::array::from_fn(|j| (self.q[j] - before[j]) / self.period_s);
        let limits = self.robot.limits();
        let speed_rel = std::array::from_fn(|j| self.dq[j] / limits.velocity_rad_s[j]);
        self.temperatures.advance(&speed_rel, self.period_s);
        let motion = self.joint_motion();
        self.torques = self.torque_sensors.read(&self.q, &motion);
        let reading = Reading {
            measured_rad: self.position_sensors.read(&self.q),
            commanded_rad: self.q,
            ipo_rad: Some(self.ipo_rad()),
            measured_torque_nm: self.torques.measured_nm,
            external_torque_nm: self.torques.external_nm,
            time: Duration::from_secs_f64(self.now_s()),
            safety: if self.pressed_until.is_some() { Safety::Stop1 } else { Safety::Normal },
        };
        self.fri.message(&reading, message)
    }

    /// Returns the interpolated joint positions of the controller's own motion, in rad. While the
    /// client commands, this motion holds the position at the request: set-points do not change it.
    fn ipo_rad(&self) -> Joints {
        match &self.activity {
            ProgramActivity::Commanded(commanded) => commanded.at_rad,
            _ => self.q,
        }
    }

    /// Returns the current joint motion: as planned or, for set-points, by their differences, which
    /// are delayed by one set-point.
    fn joint_motion(&mut self) -> JointMotion {
        let stride = self.receive_multiplier as usize;
        self.trail.push_back(self.q);
        while self.trail.len() > 2 * stride + 1 {
            self.trail.pop_front();
        }
        match &self.activity {
            ProgramActivity::Nothing => JointMotion::default(),
            ProgramActivity::Motions { playback, .. } => {
                let state = playback.motion().at(playback.at_s());
                let (rate, change) = playback.time_rate();
                JointMotion {
                    velocity_rad_s: state.dq.map(|dq| rate * dq),
                    acceleration_rad_s2: std::array::from_fn(|j| {
                        rate * rate * state.ddq[j] + change * state.dq[j]
                    }),
                }
            }
            ProgramActivity::Commanded(_) => {
                let trail = &self.trail;
                let (Some(first), Some(middle)) = (trail.front(), trail.get(stride)) else {
                    return JointMotion::default();
                };
                if trail.len() <= 2 * stride {
                    return JointMotion::default();
                }
                let step_s = self.period_s * f64::from(self.receive_multiplier);
                JointMotion {
                    velocity_rad_s: std::array::from_fn(|j| {
                        (self.q[j] - first[j]) / (2.0 * step_s)
                    }),
                    acceleration_rad_s2: std::array::from_fn(|j| {
                        (self.q[j] - 2.0 * middle[j] + first[j]) / step_s.powi(2)
                    }),
                }
            }
            ProgramActivity::Braking(braking) => braking.joint_motion(),
        }
    }

    fn advance(&mut self) {
        match std::mem::replace(&mut self.activity, ProgramActivity::Nothing) {
            ProgramActivity::Nothing => {}
            ProgramActivity::Motions { run, mut playback, from, error } => {
                playback.advance(self.period_s);
                self.q = playback.position();
                let (trajectory, at_s) = (playback.motion(), playback.at_s());
                self.torque_sensors.configure(trajectory.path(), trajectory.at(at_s).motion);
                if playback.is_over() {
                    let error = error.filter(|_| playback.is_cut_short());
                    return self.end(run, Some(from), error);
                }
                let share = playback.at_s() / playback.duration_s();
                self.activity = ProgramActivity::Motions { run, playback, from, error };
                if self.press_at.is_some_and(|threshold| share >= threshold) {
                    self.press_at = None;
                    self.press_emergency_stop(EMERGENCY_STOP_HELD_S);
                }
            }
            ProgramActivity::Commanded(commanded) => self.follow(commanded),
            ProgramActivity::Braking(mut braking) => {
                braking.for_s += self.period_s;
                // Outside the joint range, no further motion could begin.
                self.q = self.robot.limits().clamp(&braking.position());
                if braking.is_over() {
                    return self.end(braking.run, braking.from, Some(braking.error));
                }
                self.activity = ProgramActivity::Braking(braking);
            }
        }
    }

    /// Follows the client's set-points.
    fn follow(&mut self, mut commanded: Commanded) {
        let waited_s = (self.cycle - commanded.since) as f64 * self.period_s;
        let error = match (self.fri.state(), commanded.from) {
            (SessionState::CommandingActive, _) => self.follow_setpoint(&mut commanded).err(),
            (_, Some(_)) => Some(Refusal::robot(format!(
                "the FRI connection became too bad for commanding: quality {}",
                self.fri.quality().name()
            ))),
            (state, None) if waited_s > COMMANDING_TIMEOUT_S => Some(Refusal::robot(format!(
                "FRI did not reach active commanding within {COMMANDING_TIMEOUT_S} s: session {}, \
                 quality {}",
                state.name(),
                self.fri.quality().name()
            ))),
            // Requested again, because the session may have been lost meanwhile.
            (state, None) => {
                if !state.commands() {
                    self.fri.request_commanding();
                }
                None
            }
        };
        self.activity = ProgramActivity::Commanded(commanded);
        if let Some(error) = error {
            self.brake(error);
            // In this cycle, because waiting for the next one would stop the robot abruptly.
            self.advance();
        }
    }

    fn follow_setpoint(&mut self, commanded: &mut Commanded) -> Result<(), Refusal> {
        commanded.from.get_or_insert(self.cycle);
        let limits = self.robot.limits();
        if let Some(setpoint) = self.fri.setpoint() {
            if let Err(outside) = limits.check(setpoint) {
                return Err(Refusal::new(
                    Code::Limit,
                    format!("a set-point is outside a range: {outside}"),
                ));
            }
            // Times are those of the answered messages, because the answer latency varies.
            let answered = self.fri.answered().unwrap_or_default();
            let first = (self.q, answered.wrapping_sub(self.receive_multiplier));
            let (last, before) = commanded.last.unwrap_or(first);
            let elapsed_s = f64::from(answered.wrapping_sub(before).max(1)) * self.period_s;
            let max_step = |j: usize| limits.velocity_rad_s[j] * SETPOINT_MARGIN * elapsed_s;
            if let Some(j) = (0..7).find(|&j| (setpoint[j] - last[j]).abs() > max_step(j) + 1e-6) {
                return Err(Refusal::new(
                    Code::Limit,
                    format!("the set-points exceeded the velocity limit of joint A{}", j + 1),
                ));
            }
            if commanded.last.is_none_or(|(last, _)| last != *setpoint) {
                commanded.last = Some((*setpoint, answered));
                commanded.cycles_left = self.receive_multiplier;
            }
            commanded.cycles_left = commanded.cycles_left.max(1);
        }
        let Some((target, _)) = commanded.last else { return Ok(()) };
        self.q = std::array::from_fn(|j| {
            let q = self.q[j];
            let (lower, upper) = (limits.lower_rad[j], limits.upper_rad[j]);
            let step = match commanded.cycles_left {
                0 => {
                    // Without a new set-point, the motion is extrapolated as long as the joint can
                    // still stop within its range.
                    let stops = |room_rad: f64| {
                        let braking = limits.acceleration_rad_s2[j] * BRAKING_MARGIN;
                        fastest(room_rad, braking, self.period_s)
                    };
                    self.dq[j].clamp(-stops(q - lower), stops(upper - q)) * self.period_s
                }
                cycles => (target[j] - q) / f64::from(cycles),
            };
            let max_step = limits.velocity_rad_s[j] * SETPOINT_MARGIN * self.period_s;
            (q + step.clamp(-max_step, max_step)).clamp(lower, upper)
        });
        commanded.cycles_left = commanded.cycles_left.saturating_sub(1);
        Ok(())
    }

    /// Brings the robot to rest on a straight line in joint space, except for joints that would
    /// leave their range.
    fn brake(&mut self, error: Refusal) {
        if let ProgramActivity::Commanded(Commanded { run, from, .. }) = self.activity {
            self.fri.release();
            let limits = self.robot.limits();
            let takes_s = std::array::from_fn(|j| {
                let speed = self.dq[j];
                let end_rad = if speed > 0.0 { limits.upper_rad[j] } else { limits.lower_rad[j] };
                let room_rad = ((end_rad - self.q[j]) * speed.signum()).max(0.0);
                if speed == 0.0 { 0.0 } else { EMERGENCY_STOP_S.min(2.0 * room_rad / speed.abs()) }
            });
            self.activity = ProgramActivity::Braking(JointBraking {
                run,
                state: DriveState::RunningTrajectory,
                from,
                began_rad: self.q,
                speed_rad_s: self.dq,
                takes_s,
                for_s: 0.0,
                error,
            });
        }
    }

    fn end(&mut self, run: RunId, from: Option<u64>, error: Option<Refusal>) {
        self.fri.release();
        self.outcome = Some(Outcome {
            run,
            start_s: from.filter(|_| !self.without_times).map(|from| self.at_s(from)),
            end_s: (!self.without_times).then(|| self.now_s()),
            error,
        });
        self.activity = ProgramActivity::Nothing;
        self.changed = true;
    }

    /// Checks that a run may begin.
    pub(crate) fn check_ready(&self) -> Result<(), Refusal> {
        if self.pressed_until.is_some() {
            return Err(Refusal::robot("the emergency stop is pressed"));
        }
        match &self.activity {
            ProgramActivity::Nothing => Ok(()),
            _ => Err(Refusal::new(Code::NotIdle, "the robot is busy with another run")),
        }
    }

    /// Begins planned motions.
    pub(crate) fn begin(&mut self, run: RunId, trajectory: Trajectory) -> Result<(), Refusal> {
        self.check_ready()?;
        let start = trajectory.at(0.0).q;
        if (0..7).any(|j| (start[j] - self.q[j]).abs() > 1e-9) {
            return Err(Refusal::robot("the arm has moved since the motions were planned"));
        }
        let playback = Box::new(Playback::new(trajectory));
        self.activity = ProgramActivity::Motions { run, playback, from: self.cycle, error: None };
        self.changed = true;
        Ok(())
    }

    /// Carries out an instruction other than motion instructions.
    pub(crate) fn carry_out(
        &mut self,
        instruction: Instruction,
    ) -> Result<Acknowledgement, Refusal> {
        let mut answer = Acknowledgement::default();
        match instruction {
            Instruction::RunMotions { .. } | Instruction::Begin { .. } => {}
            Instruction::RunTrajectory { run } => {
                self.check_ready()?;
                if self.period_s > MAX_COMMANDING_PERIOD_S {
                    return Err(Refusal::robot(format!(
                        "FRI sends every {} ms; commanding requires every 1 to {} ms",
                        self.period_s * 1e3,
                        MAX_COMMANDING_PERIOD_S * 1e3
                    )));
                }
                self.fri.request_commanding();
                self.activity = ProgramActivity::Commanded(Commanded {
                    run,
                    since: self.cycle,
                    at_rad: self.q,
                    from: None,
                    last: None,
                    cycles_left: 0,
                });
                self.changed = true;
            }
            Instruction::EndTrajectory { run } => {
                if let ProgramActivity::Commanded(commanded) = &self.activity
                    && commanded.run == run
                {
                    if self.dq.iter().any(|dq| dq.abs() > REST_RAD_S) {
                        self.brake(Refusal::robot("the trajectory was ended while the arm moved"));
                    } else {
                        let from = commanded.from;
                        self.end(run, from, None);
                    }
                }
            }
            Instruction::Stop => match &mut self.activity {
                ProgramActivity::Nothing | ProgramActivity::Braking(_) => {}
                ProgramActivity::Motions { playback, error, .. } => {
                    let (at_s, of_s) = (playback.at_s(), playback.duration_s());
                    playback.stop(STOP_S);
                    error.get_or_insert_with(|| {
                        Refusal::robot(format!("stopped on request at {at_s:.2} of {of_s:.2} s"))
                    });
                }
                ProgramActivity::Commanded(_) => {
                    self.brake(Refusal::robot("stopped on request"));
                }
            },
            Instruction::ReadSensors => {
                let temperatures = (!self.without_times).then(|| self.temperatures.celsius());
                answer.sensors = Some(Sensors::new(temperatures, self.torques.external_nm));
            }
            Instruction::ListIo => answer.io = Some(self.ports.all()),
            Instruction::GetIo { name } => answer.value = Some(self.ports.get(&name)?),
            Instruction::SetIo { name, value } => {
                answer.value = Some(self.ports.set(&name, value)?);
            }
        }
        Ok(answer)
    }
}

/// Duration of a simulated emergency stop, in s.
pub(crate) const EMERGENCY_STOP_HELD_S: f64 = 2.0;

/// Velocity below which a joint counts as at rest, in rad/s.
const REST_RAD_S: f64 = 1e-3;

/// Plans motions from `start_rad`, in rad.
pub(crate) fn plan(
    robot: &Robot,
    start_rad: Joints,
    motions: MotionList,
) -> Result<Trajectory, Refusal> {
    if motions.motions.iter().any(|motion| motion.io().is_some()) {
        return Err(Refusal::bad("a run has no inputs and outputs: use `set_io` and `get_io`"));
    }
    let path = JointPath::new(&motions.starting_at(start_rad), robot)
        .map_err(|fault| Refusal::of_fault(&fault))?;
    Trajectory::plan(&path, Timing::default()).map_err(|error| Refusal::robot(error.to_string()))
}
