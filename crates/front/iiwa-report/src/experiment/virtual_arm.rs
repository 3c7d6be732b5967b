//! Virtual robot that runs the programs of an experiment.

use iiwa_eval::{LoadPlanning, VirtualRobot, experiment::Trial};
use iiwa_kin::Robot;
use iiwa_log::JointLog;
use iiwa_program::Motion;

use crate::ExperimentError;

/// Standard deviation of torques, in Nm, in programs with a load.
const TORQUE_NOISE_NM: f64 = 0.1;

/// Robot model in this process, sampled with noise.
#[derive(Clone, Debug)]
pub struct VirtualArm {
    /// Robot model.
    pub robot: Robot,
    /// Standard deviation of each sample, in rad.
    pub noise_rad: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// Treatment of loads by its planner.
    pub load_planning: LoadPlanning,
}

impl VirtualArm {
    /// Runs a program and returns the samples. The noise of a program does not depend on earlier
    /// runs.
    ///
    /// # Errors
    ///
    /// [`ExperimentError::VirtualRobot`] if the robot cannot run the program.
    pub fn run(&self, trial: &Trial) -> Result<JointLog, ExperimentError> {
        // FNV-1a hash.
        let seed = trial.name.bytes().fold(self.seed ^ 0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        let mut robot = VirtualRobot::new(self.robot.clone(), seed);
        (robot.noise_rad, robot.load_planning) = (self.noise_rad, self.load_planning);
        // Torques are needed to verify the mounted load.
        let with_load = matches!(trial.program.motions.first(), Some(Motion::Load(_)));
        robot.torque_noise_nm = with_load.then_some(TORQUE_NOISE_NM);
        robot.period_s = self.rate_hz.recip();
        robot
            .run(&trial.program)
            .map_err(|source| ExperimentError::VirtualRobot { name: trial.name.clone(), source })
    }
}
