//! Errors of the twin.

use std::{error::Error, io, path::PathBuf};

use iiwa_files::OutputError;
use iiwa_foxglove::ViewersError;
use iiwa_json::JsonPlace;
use iiwa_link::LinkError;
use iiwa_log::WriteError;
use iiwa_page::PageError;

/// Failure of the twin.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// The connection to the drive failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The page of a plan cannot be created.
    #[error(transparent)]
    Page(#[from] PageError),
    /// The viewer connection failed.
    #[error(transparent)]
    Viewers(#[from] ViewersError),
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A recording cannot be written.
    #[error("cannot write the recording")]
    Recording(#[from] WriteError),
    /// A file of a program cannot be written, or a folder cannot be created.
    #[error("cannot {operation}")]
    File {
        /// Failed operation, such as `write a.json`.
        operation: String,
        /// Cause.
        source: io::Error,
    },
    /// All file names for a program are in use.
    #[error("all file names are taken")]
    NoNameLeft,
    /// The page cannot be served.
    #[error("cannot serve the page")]
    Serve(#[source] io::Error),
    /// A token cannot be created.
    #[error("the system gives no random numbers")]
    Random(#[source] getrandom::Error),
    /// An internal task for a page failed.
    #[error("{message}")]
    BrokenDown {
        /// Failure, such as `planning failed`.
        message: &'static str,
        /// Cause.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A program is invalid, or cannot be planned.
    #[error(
        "{name}{}: {}",
        error.place().map_or(String::new(), |place| format!(", {place}")),
        error.message()
    )]
    Program {
        /// Name of the program.
        name: String,
        /// Text of the program.
        text: String,
        /// Fault of the program.
        error: Box<iiwa_plan::Error>,
    },
    /// The file of saved positions is not valid JSON of this kind.
    #[error("{}, {place}: {message}", file.display())]
    PositionsText {
        /// Path of the file.
        file: PathBuf,
        /// Content of the file.
        text: String,
        /// Place of the fault in the content.
        place: JsonPlace,
        /// Fault of the file.
        message: String,
    },
    /// The file of saved positions has content that the twin rejects.
    #[error("{}: {message}", file.display())]
    Positions {
        /// Path of the file.
        file: PathBuf,
        /// Fault of the file.
        message: String,
    },
    /// The saved positions belong to another robot.
    #[error(
        "{}: the positions were saved for the robot `{robot}`, but the twin follows {twin_robot}",
        file.display()
    )]
    PositionsOfAnother {
        /// Path of the file.
        file: PathBuf,
        /// Robot of the positions.
        robot: String,
        /// Robot of the twin.
        twin_robot: String,
    },
}

impl TwinError {
    pub(crate) fn file(message: impl Into<String>, source: io::Error) -> Self {
        Self::File { operation: message.into(), source }
    }
}
