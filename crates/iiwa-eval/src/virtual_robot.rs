//! A robot inside the process: it runs programs and is sampled, as a real one is over FRI.

use fastrand_contrib::RngExt;
use iiwa_kin::Robot;
use iiwa_log::{JointLog, PlanOptions};
use iiwa_program::Program;
use iiwa_traj::PlanError;

/// A robot whose limits, kappa and time to settle may differ from the model's.
#[derive(Clone, Debug)]
pub struct VirtualRobot {
    /// What it is.
    pub robot: Robot,
    /// Time from one sample to the next, in s; 1 ms by default.
    pub period_s: f64,
    /// Standard deviation of each joint's samples, in rad; none by default.
    pub noise_rad: f64,
    /// For how long it stands before and after a program, in s; 0.2 by default.
    pub standing_s: f64,
    random: fastrand::Rng,
}

/// Samples of one program at most, some 640 MB.
const MAX_SAMPLES: f64 = 1e7;

/// Why a program could not be run.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VirtualRobotError {
    /// The program cannot be planned for the robot.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// It takes too long to be sampled.
    #[error(
        "it takes {seconds:.0} s, which is {samples:.0} samples, and {MAX_SAMPLES:.0} are kept: sample more \
         slowly, or raise the robot's limits"
    )]
    TooLong {
        /// How long it takes.
        seconds: f64,
        /// How many samples that would be.
        samples: f64,
    },
}

impl VirtualRobot {
    /// A robot without noise that is sampled every ms. The same `seed` gives the same noise.
    #[must_use]
    pub fn new(robot: Robot, seed: u64) -> Self {
        let random = fastrand::Rng::with_seed(seed);
        Self { robot, period_s: 1e-3, noise_rad: 0.0, standing_s: 0.2, random }
    }

    /// Runs a program under limits of speed, acceleration and jerk, and gives what was sampled.
    ///
    /// # Errors
    ///
    /// If the program asks for something that the robot cannot do.
    pub fn run(&mut self, program: &Program) -> Result<JointLog, VirtualRobotError> {
        let trajectory = PlanOptions::default().plan(program, &self.robot)?;
        // It does not begin just at a sample.
        let begin_s = self.standing_s + self.random.f64() * self.period_s;
        let whole_s = begin_s + trajectory.cycle_time_s() + self.standing_s;
        let samples = whole_s / self.period_s;
        if samples > MAX_SAMPLES {
            return Err(VirtualRobotError::TooLong { seconds: whole_s, samples });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let count = samples as usize;
        let t_s: Vec<f64> = (0..=count).map(|i| i as f64 * self.period_s).collect();
        let sample = |t_s: &f64| {
            let q = trajectory.at(t_s - begin_s).q;
            q.map(|q| q + self.noise_rad * self.random.f64_normal(0.0, 1.0))
        };
        let q_rad = t_s.iter().map(sample).collect();
        Ok(JointLog::new(t_s, q_rad))
    }
}
