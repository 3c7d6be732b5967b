//! Errors of programs in JSON.

use serde::Serialize;

/// Error of a program, as `--json` prints it for several programs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ErrorRecord {
    /// File with the error: the program, or a file that it names. Absent, as line and column, if
    /// the error has no place in a text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Line, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Column in characters, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<usize>,
    /// Error message without the place.
    pub message: String,
}

/// Errors of a program that failed. As JSON, this is a part of the line of the program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ProgramErrors {
    /// The first error with its place, and the number of the others.
    pub error: String,
    /// All errors.
    pub errors: Vec<ErrorRecord>,
}
