//! A virtual robot that runs the programs of an experiment.

use iiwa_eval::{VirtualRobot, experiment::Trial};
use iiwa_kin::Robot;
use iiwa_log::JointLog;

use crate::ViewError;

/// A robot inside the process, sampled with noise.
#[derive(Clone, Debug)]
pub struct VirtualArm {
    /// The robot.
    pub robot: Robot,
    /// Standard deviation of each sample, in rad.
    pub noise_rad: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl VirtualArm {
    /// Runs a program and gives what was sampled. The noise of a program does not depend on what ran
    /// before it.
    ///
    /// # Errors
    ///
    /// [`ViewError::VirtualRobot`] if the robot cannot run the program.
    pub fn run(&self, trial: &Trial) -> Result<JointLog, ViewError> {
        // FNV-1a.
        let seed = trial.name.bytes().fold(self.seed ^ 0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        let mut robot = VirtualRobot::new(self.robot.clone(), seed);
        robot.noise_rad = self.noise_rad;
        robot.period_s = self.rate_hz.recip();
        robot
            .run(&trial.program)
            .map_err(|source| ViewError::VirtualRobot { name: trial.name.clone(), source })
    }
}
