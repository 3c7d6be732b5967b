//! Simulated robot: runs programs and records samples, as FRI does from a real robot.

use fastrand_contrib::RngExt;
use iiwa_kin::{Load, Robot};
use iiwa_log::JointLog;
use iiwa_plan::PlanOptions;
use iiwa_program::Program;
use iiwa_traj::{PlanError, Timing};

use crate::LoadPlanning;

/// Robot whose limits, kappa and settle time may differ from the model's.
#[derive(Clone, Debug)]
pub struct VirtualRobot {
    /// Simulated robot.
    pub robot: Robot,
    /// Sampling period, in s; 1 ms by default.
    pub period_s: f64,
    /// Standard deviation of each joint's samples, in rad; 0 by default.
    pub noise_rad: f64,
    /// Standard deviation of each joint's torque, in Nm; if unset, torques are not measured.
    pub torque_noise_nm: Option<f64>,
    /// Actual payload, independent of the programs; if unset, the payload that they state.
    pub load: Option<Load>,
    /// Planning options; jerk-limited timing by default.
    pub plan: PlanOptions,
    /// Effect of the stated payload on planning; none by default.
    pub load_planning: LoadPlanning,
    /// Time at rest before and after a program, in s; 0.2 by default.
    pub standing_s: f64,
    random: fastrand::Rng,
}

/// Maximum number of samples of one program, some 640 MB.
const MAX_SAMPLES: f64 = 1e7;

/// Error of running a program.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VirtualRobotError {
    /// The program cannot be planned for the robot.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The program has too many samples.
    #[error(
        "the program takes {seconds:.0} s, which is {samples:.0} samples; the maximum is \
         {MAX_SAMPLES:.0}: increase the sampling period, or raise the robot's limits"
    )]
    TooLong {
        /// Duration, in s.
        seconds: f64,
        /// Number of samples.
        samples: f64,
    },
}

impl VirtualRobot {
    /// Creates a robot without noise, with a sampling period of 1 ms. The same `seed` gives the
    /// same noise.
    #[must_use]
    pub fn new(robot: Robot, seed: u64) -> Self {
        let random = fastrand::Rng::with_seed(seed);
        Self {
            robot,
            period_s: 1e-3,
            noise_rad: 0.0,
            torque_noise_nm: None,
            load: None,
            plan: PlanOptions::with_timing(Timing::jerk_limited()),
            load_planning: LoadPlanning::Ignored,
            standing_s: 0.2,
            random,
        }
    }

    /// Runs a program and returns the samples, with torques in the sign of KUKA's controller.
    ///
    /// # Errors
    ///
    /// If the robot cannot execute the program.
    pub fn run(&mut self, program: &Program) -> Result<JointLog, VirtualRobotError> {
        let program = self.load_planning.slowed(program, &self.robot)?;
        let trajectory = self.plan.plan(&program, &self.robot)?;
        // Motion does not start exactly at a sample.
        let begin_s = self.standing_s + self.random.f64() * self.period_s;
        let whole_s = begin_s + trajectory.cycle_time_s() + self.standing_s;
        let samples = whole_s / self.period_s;
        if samples > MAX_SAMPLES {
            return Err(VirtualRobotError::TooLong { seconds: whole_s, samples });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let count = samples as usize;
        let t_s: Vec<f64> = (0..=count).map(|i| i as f64 * self.period_s).collect();
        let mut q_rad = Vec::with_capacity(t_s.len());
        let mut measured_nm = Vec::new();
        let path = trajectory.path();
        for t_s in &t_s {
            let state = trajectory.at(t_s - begin_s);
            let noise =
                |random: &mut fastrand::Rng, deviation| deviation * random.f64_normal(0.0, 1.0);
            q_rad.push(state.q.map(|q| q + noise(&mut self.random, self.noise_rad)));
            let Some(deviation_nm) = self.torque_noise_nm else { continue };
            let torques = match &self.load {
                None => trajectory.torques_of(&state).torque_nm,
                Some(load) => {
                    let empty = self.robot.dynamics().with_mount(path.mount());
                    let rigid = empty.with_load(load).torques(&state.q, &state.dq, &state.ddq);
                    let friction = empty.friction().torques_nm(&state.dq);
                    std::array::from_fn(|j| rigid[j] + friction[j])
                }
            };
            measured_nm.push(Some(torques.map(|nm| -nm + noise(&mut self.random, deviation_nm))));
        }
        let mut log = JointLog::new(t_s, q_rad);
        log.torques_nm = measured_nm;
        Ok(log)
    }
}
