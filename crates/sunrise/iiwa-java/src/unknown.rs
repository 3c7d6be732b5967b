//! What cannot be known before a program runs.

use std::fmt;

use crate::place::Place;

/// Why a value is not known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// What it depends on, as a noun: "a measured force", "the result of `Camera.locate`, a library without source".
    pub reason: String,
    /// Where it came into the program.
    pub place: Place,
    /// True for the result of a method that is not modelled: the call may have changed its receiver and its arguments.
    pub is_unmodelled_call: bool,
}

impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)
    }
}
