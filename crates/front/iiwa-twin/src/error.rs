//! Why a twin does not start, or cannot do what a page asks for.

use std::{error::Error, io, path::PathBuf};

use iiwa_files::OutputError;
use iiwa_foxglove::ViewersError;
use iiwa_json::Place;
use iiwa_link::LinkError;
use iiwa_log::WriteError;
use iiwa_page::PageError;

/// A failure of the twin.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// A connection to the drive cannot be made.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A page cannot be made of a plan.
    #[error(transparent)]
    Page(#[from] PageError),
    /// Viewers cannot be served.
    #[error(transparent)]
    Viewers(#[from] ViewersError),
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A recording cannot be made.
    #[error("cannot write the recording")]
    Recording(#[from] WriteError),
    /// A file of a program is not written, or a folder is not made.
    #[error("cannot {what}")]
    File {
        /// What cannot be done, as in `write a.json`.
        what: String,
        /// Why.
        source: io::Error,
    },
    /// All names of a program's files are taken.
    #[error("there is no file name left")]
    NoNameLeft,
    /// The page is not served.
    #[error("cannot serve the page")]
    Serve(#[source] io::Error),
    /// A token cannot be made.
    #[error("the system gives no random numbers")]
    Random(#[source] getrandom::Error),
    /// The work for a page broke down.
    #[error("{what}")]
    BrokenDown {
        /// What failed, as in `planning failed`.
        what: &'static str,
        /// How.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A program is not valid, or cannot be planned.
    #[error("{name}{}: {}", error.place().map_or(String::new(), |place| format!(", {place}")), error.what())]
    Program {
        /// The name of the program.
        name: String,
        /// Its text.
        text: String,
        /// The fault.
        error: Box<iiwa_plan::Error>,
    },
    /// The file of saved positions is not JSON of this kind.
    #[error("{}, {place}: {what}", file.display())]
    PositionsText {
        /// The file.
        file: PathBuf,
        /// What it says.
        text: String,
        /// Where the fault is in it.
        place: Place,
        /// The fault.
        what: String,
    },
    /// The file of saved positions holds what this twin does not take.
    #[error("{}: {what}", file.display())]
    Positions {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The saved positions are of another robot.
    #[error("{}: positions of the robot `{robot}`, not of {own}", file.display())]
    PositionsOfAnother {
        /// The file.
        file: PathBuf,
        /// Whose they are.
        robot: String,
        /// The twin's own.
        own: String,
    },
}

impl TwinError {
    pub(crate) fn file(what: impl Into<String>, source: io::Error) -> Self {
        Self::File { what: what.into(), source }
    }
}
