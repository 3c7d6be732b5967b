//! Twin failures in commands and on pages.

use iiwa_twin::{TwinError, Wording};

use crate::{connection, failure::Failure, runner};

/// Error texts on pages: the same as in commands.
pub(crate) const WORDING: Wording = Wording {
    error: |error| Failure::from(error).message(),
    request: connection::explained,
    refusal: runner::hint,
    unknown_position: runner::unknown_position,
    address: "that `iiwasim twin` prints",
};

impl From<TwinError> for Failure {
    fn from(error: TwinError) -> Self {
        Self::from(&error)
    }
}

impl From<&TwinError> for Failure {
    fn from(error: &TwinError) -> Self {
        match error {
            TwinError::Link(error) => connection::link_failure(error),
            TwinError::Page(error) => error.into(),
            TwinError::Viewers(error) => Self::run(error.operation.clone(), &*error.cause),
            TwinError::Output(error) => error.into(),
            TwinError::Program { name, text, error } => Self::program(error, name, text),
            TwinError::PositionsText { file, text, place, message } => {
                Self::in_text(message, place, &file.display().to_string(), text)
            }
            TwinError::Positions { .. } => Self::input(error.to_string()),
            TwinError::PositionsOfAnother { .. } => {
                Self::input(format!("{error}; name another file with --positions"))
            }
            error => Self::broken(error),
        }
    }
}
