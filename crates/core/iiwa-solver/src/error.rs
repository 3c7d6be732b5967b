//! Errors of the solver.

use thiserror::Error;

/// An error of the solver: it returns no solution.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum SolveError {
    /// No attempt came near enough to the optimum.
    #[error("no attempt came near enough to the optimum")]
    NotConverged,
    /// The stop flag of the caller was set.
    #[error("interrupted")]
    Interrupted,
}
