//! Values that are unknown before a program runs.

use std::fmt;

use crate::place::SourceLine;

/// Reason why a value is unknown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// Origin as a noun: "a measured force", "the result of `Camera.locate`, a library without
    /// source".
    pub reason: String,
    /// Place at which the value entered the program.
    pub place: SourceLine,
    /// `true` for the result of an unmodelled method: the call may have changed its receiver and
    /// its arguments.
    pub is_unmodelled_call: bool,
}

impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)
    }
}
