//! Limits other than velocity, acceleration and jerk limits.

use std::fmt;

use iiwa_path::JointPath;
use iiwa_solver::RowLimit;

use crate::{limit::Limit, timing::TimingError};

/// Largest joint rotation between two points or instants at which such limits are checked, in rad.
pub(crate) const MAX_RAD: f64 = 0.05;

/// Kind of limit other than velocity, acceleration and jerk limits, as rows
/// `-1 <= a u + b x + c <= 1` with the acceleration u along the path and the squared speed x.
///
/// Sweep, solver, checks and figures access further limits through this trait alone. A
/// [`Planner`](crate::Planner) has torque limits and accepts [more](crate::Planner::with_limit).
pub trait PathLimit: fmt::Debug + Send + Sync {
    /// Returns the limit along the step at `step`; none if the step is not limited.
    fn of_step(&self, path: &JointPath, step: usize) -> Option<Box<dyn RowLimit>>;

    /// Returns the limit that a row of [`of_step`](Self::of_step) represents in figures and errors.
    fn limit(&self, row: usize) -> Limit;

    /// Checks before planning that the limit can be kept along a path at all. The default accepts
    /// any path.
    ///
    /// # Errors
    ///
    /// The limit cannot be kept.
    fn check(&self, path: &JointPath) -> Result<(), TimingError> {
        let _ = path;
        Ok(())
    }
}
