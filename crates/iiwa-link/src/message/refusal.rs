//! Why something was not done.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The kinds of errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Code {
    /// The request is not understood, or asks for what there is not.
    BadRequest,
    /// Another motion or trajectory is running.
    NotIdle,
    /// A limit of the robot would be exceeded.
    Limit,
    /// A trajectory does not start where the robot is.
    StartMismatch,
    /// The robot cannot, or has stopped.
    Robot,
    /// No answer in time.
    Timeout,
    /// The other side does not know the key.
    Unauthorized,
}

impl Code {
    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::BadRequest => "bad_request",
            Self::NotIdle => "not_idle",
            Self::Limit => "limit",
            Self::StartMismatch => "start_mismatch",
            Self::Robot => "robot",
            Self::Timeout => "timeout",
            Self::Unauthorized => "unauthorized",
        }
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Why a request was not, or not wholly, carried out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[error("{message} ({code})")]
pub struct Refusal {
    /// The kind of error.
    pub code: Code,
    /// What is wrong, for people.
    pub message: String,
}

impl Refusal {
    /// A refusal with this code.
    #[must_use]
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }

    /// The request makes no sense.
    #[must_use]
    pub fn bad(message: impl Into<String>) -> Self {
        Self::new(Code::BadRequest, message)
    }

    /// The robot cannot do it.
    #[must_use]
    pub fn robot(message: impl Into<String>) -> Self {
        Self::new(Code::Robot, message)
    }
}
