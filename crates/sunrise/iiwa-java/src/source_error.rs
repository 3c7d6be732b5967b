//! Why a source file of a project cannot be used.

/// What is wrong with a source file, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: {fault}")]
pub struct SourceError {
    /// The file, from the project's folder on, with `/`.
    pub file: String,
    /// From 1; 1 if the file as a whole is meant.
    pub line: u32,
    /// In characters, from 1.
    pub column: u32,
    /// What is wrong.
    pub fault: SourceFault,
}

/// What is wrong with a source file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SourceFault {
    /// The system does not give the file's contents.
    #[error("the file cannot be read: {0}")]
    Unreadable(String),
    /// The file is larger than any that people write.
    #[error("the file has {bytes} bytes, and at most {most} are read")]
    TooLarge {
        /// Of the file.
        bytes: u64,
        /// That are read.
        most: u64,
    },
    /// The file is no text.
    #[error("a byte of 0 is here, which no text has: the file is no source of Java")]
    Binary,
    /// There are more tokens than in any file that people write.
    #[error("the file goes on after {most} tokens, and no more are read")]
    TooManyTokens {
        /// That are read.
        most: usize,
    },
    /// Something is nested too deeply, or a chain of it is too long.
    #[error("{what} here, and at most {most} are read")]
    TooDeep {
        /// What there is too much of, as "more than 200 brackets are open".
        what: &'static str,
        /// That are read.
        most: usize,
    },
    /// Something is so long that the parser would take minutes.
    #[error("{0} here, and reading it would take too long")]
    TooLong(&'static str),
    /// The text is not Java.
    #[error("{0}")]
    Syntax(String),
    /// The parser came to no result.
    #[error("the parser came to no result: {0}")]
    Parser(String),
}
