//! Limits beside those of velocity, acceleration and jerk.

use std::fmt;

use iiwa_path::JointPath;
use iiwa_solver::RowLimit;

use crate::{limit::Limit, timing::TimingError};

/// No joint turns by more between two places or instants at which such limits are checked, in rad.
pub(crate) const MOST_RAD: f64 = 0.05;

/// A kind of limit beside those of velocity, acceleration and jerk: as rows `-1 <= a u + b x + c <= 1`, with the acceleration u along
/// the path and the square x of the speed.
///
/// Sweep, solver, checks and figures know limits by this trait alone. A [`Planner`](crate::Planner) has those of torque, and takes
/// [more](crate::Planner::with_limit).
pub trait PathLimit: fmt::Debug + Send + Sync {
    /// The limit along the step at `step`; none if it does not limit that.
    fn of_step(&self, path: &JointPath, step: usize) -> Option<Box<dyn RowLimit>>;

    /// The limit that a row of [`of_step`](Self::of_step) stands for, in figures and errors.
    fn limit(&self, row: usize) -> Limit;

    /// Checks that the limit can be kept along a path at all, before that is planned. By default nothing is checked.
    ///
    /// # Errors
    ///
    /// It cannot.
    fn check(&self, path: &JointPath) -> Result<(), TimingError> {
        let _ = path;
        Ok(())
    }
}
