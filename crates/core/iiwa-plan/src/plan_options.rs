//! Options of path and timing.

use iiwa_kin::Robot;
use iiwa_path::{JointPath, PathOptions};
use iiwa_program::Program;
use iiwa_traj::{PlanError, Timing, Trajectory};

/// Options for planning a program.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlanOptions {
    /// Path options.
    pub path: PathOptions,
    /// Timing method, which determines the limits that apply.
    pub timing: Timing,
    /// Number of samples per blend in the sweep under acceleration limits, as stated in the
    /// figures.
    pub samples: u32,
}

impl PlanOptions {
    /// Default path options with this timing.
    #[must_use]
    pub fn with_timing(timing: Timing) -> Self {
        Self { timing, ..Self::default() }
    }

    /// Plans a whole program for `robot`.
    ///
    /// # Errors
    ///
    /// [`PlanError::Fault`] if the program names another robot or flange, or requires something
    /// that the robot cannot do, [`PlanError::Timing`] if no trajectory was found.
    pub fn plan(&self, program: &Program, robot: &Robot) -> Result<Trajectory, PlanError> {
        let path = JointPath::with_options(program, robot, self.path)?;
        Ok(Trajectory::plan(&path, self.timing)?)
    }
}
