//! Errors of source files.

/// Fault of a source file, with its place.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: {fault}")]
pub struct SourceError {
    /// Path of the file, relative to the project folder, with `/`.
    pub file: String,
    /// Line from 1; 1 for the file as a whole.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// Fault.
    pub fault: SourceFault,
}

/// Fault of a source file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SourceFault {
    /// The file cannot be read.
    #[error("the file cannot be read: {0}")]
    Unreadable(String),
    /// The file is larger than any hand-written file.
    #[error("the file has {bytes} bytes, and at most {most} are read")]
    TooLarge {
        /// Size of the file.
        bytes: u64,
        /// Maximum size.
        most: u64,
    },
    /// The file is not a text file.
    #[error("unexpected zero byte: the file is not Java source")]
    Binary,
    /// The file has more tokens than any hand-written file.
    #[error("the file has more than {most} tokens, the largest number that is read")]
    TooManyTokens {
        /// Maximum number of tokens.
        most: usize,
    },
    /// The nesting is too deep, or a chain is too long.
    #[error("{what} here, and at most {most} are read")]
    TooDeep {
        /// Excess, such as "more than 200 brackets are open".
        what: &'static str,
        /// Maximum depth.
        most: usize,
    },
    /// An element is so long that parsing would take minutes.
    #[error("{0} here, and reading it would take too long")]
    TooLong(&'static str),
    /// The text is not Java.
    #[error("{0}")]
    Syntax(String),
    /// The parser returned no result.
    #[error("the parser came to no result: {0}")]
    Parser(String),
}
