//! Errors in replies.

use std::fmt;

use iiwa_program::Fault;
use serde::{Deserialize, Serialize};

/// Error codes of the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Code {
    /// The request is malformed or contains an unknown name.
    BadRequest,
    /// Another motion or trajectory is running.
    NotIdle,
    /// A limit of the robot would be exceeded.
    Limit,
    /// The trajectory does not start at the position of the robot.
    StartMismatch,
    /// The robot cannot carry out the request, or has stopped.
    Robot,
    /// A deadline has passed.
    Timeout,
    /// The server does not accept the key.
    Unauthorized,
}

impl Code {
    /// Returns the name in JSON, in snake case.
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

/// The reason why a request was not, or not completely, carried out.
///
/// ```
/// use iiwa_link::message::{Code, Refusal};
///
/// let refusal = Refusal::new(Code::NotIdle, "a motion is running");
/// assert_eq!(refusal.to_string(), "a motion is running");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[error("{message}")]
pub struct Refusal {
    /// The error code.
    pub code: Code,
    /// A description for people.
    pub message: String,
}

impl Refusal {
    /// Creates a refusal with this code.
    #[must_use]
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }

    /// Creates a refusal with [`Code::BadRequest`].
    #[must_use]
    pub fn bad(message: impl Into<String>) -> Self {
        Self::new(Code::BadRequest, message)
    }

    /// Creates a refusal of motions: with [`Code::Limit`] if the robot cannot execute them, and
    /// with [`Code::BadRequest`] if they are invalid, such as for an unknown name.
    #[must_use]
    pub fn of_fault(fault: &Fault) -> Self {
        let code = if fault.is_of_the_arm() { Code::Limit } else { Code::BadRequest };
        Self::new(code, fault.to_string())
    }

    /// Creates a refusal with [`Code::Robot`].
    #[must_use]
    pub fn robot(message: impl Into<String>) -> Self {
        Self::new(Code::Robot, message)
    }
}
