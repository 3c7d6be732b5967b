//! Why there is no solution.

use thiserror::Error;

/// Why there is no solution.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum SolveError {
    /// No attempt came near enough to the optimum.
    #[error("no attempt came near enough to the optimum")]
    NotConverged,
    /// The caller's flag was set.
    #[error("interrupted")]
    Interrupted,
}
