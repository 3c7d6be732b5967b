//! Faults of a Parquet file.

use crate::JointLogError;

/// Damaged or unsupported content of a file.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct ParquetFault(String);

impl ParquetFault {
    pub(super) fn new(message: impl Into<String>) -> Self {
        Self(message.into())
    }

    /// Adds the place of the fault.
    pub(super) fn at(self, place: &str) -> Self {
        Self(format!("{place}: {}", self.0))
    }
}

impl From<ParquetFault> for JointLogError {
    fn from(fault: ParquetFault) -> Self {
        Self::Parquet { message: fault.0 }
    }
}
