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
    #[error("the file has {bytes} bytes, and at most {max_bytes} are read")]
    TooLarge {
        /// Size of the file.
        bytes: u64,
        /// Maximum size.
        max_bytes: u64,
    },
    /// The file is not a text file.
    #[error("unexpected zero byte: the file is not Java source")]
    Binary,
    /// The file has more tokens than any hand-written file.
    #[error("the file has more than {max_tokens} tokens, the largest number that is read")]
    TooManyTokens {
        /// Maximum number of tokens.
        max_tokens: usize,
    },
    /// The nesting is too deep, or a chain is too long.
    #[error("{excess} here, and at most {max_depth} are read")]
    TooDeep {
        /// Excess, such as "more than 200 brackets are open".
        excess: &'static str,
        /// Maximum depth.
        max_depth: usize,
    },
    /// An element is so long that parsing would take minutes.
    #[error("{0} here, and reading it would take too long")]
    TooLong(&'static str),
    /// The text is not Java.
    #[error("{0}")]
    Syntax(String),
    /// The parser returned no result.
    #[error("the parser failed: {0}")]
    Parser(String),
}
