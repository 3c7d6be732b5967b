//! How a program is planned.

use iiwa_kin::Robot;
use iiwa_path::{JointPath, PathOptions};
use iiwa_program::Program;
use iiwa_traj::{PlanError, Timing, Trajectory};

/// How a program is planned.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlanOptions {
    /// How its path is made.
    pub path: PathOptions,
    /// Which limits are kept.
    pub timing: Timing,
    /// Samples per blend of the sweep under limits of acceleration, as the figures state them.
    pub samples: u32,
}

impl PlanOptions {
    /// The default path with this timing.
    #[must_use]
    pub fn with_timing(timing: Timing) -> Self {
        Self { timing, ..Self::default() }
    }

    /// Plans a whole program for `robot`, whichever robot it names.
    ///
    /// # Errors
    ///
    /// [`PlanError::Fault`] if the program asks for something that the robot cannot do,
    /// [`PlanError::Timing`] if no trajectory was found.
    pub fn plan(&self, program: &Program, robot: &Robot) -> Result<Trajectory, PlanError> {
        let path = JointPath::with_options(program, robot, self.path)?;
        Ok(Trajectory::plan(&path, self.timing)?)
    }
}
