//! Why an application is not imported.

use crate::{DataFileError, Question, QuestionKind, RobotStatement, SourceError};
use iiwa_kin::BadLength;
use iiwa_program::{Program, Source};

use crate::application::{applications::Application, import_note::ImportNote, missing::Missing};

/// Why an application is not imported.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The project has none.
    #[error(
        "there is no application in the project's {files} Java files: none of their classes extends RoboticsAPIApplication"
    )]
    NoApplications {
        /// How many files were read.
        files: usize,
    },
    /// The project has several, and it is not said which.
    #[error("the project has several applications: {}; name one of them", names(.known))]
    Several {
        /// Those that there are.
        known: Vec<Application>,
    },
    /// There is none of this name.
    #[error("the project has no application `{name}`; it has {}", names(.known))]
    Unknown {
        /// The name.
        name: String,
        /// Those that there are.
        known: Vec<Application>,
    },
    /// A source file that is needed cannot be used.
    #[error(transparent)]
    Source(SourceError),
    /// The data file cannot be used.
    #[error("{path}: {fault}")]
    DataFile {
        /// The file, from the project's folder on.
        path: String,
        /// What is wrong with it.
        fault: DataFileError,
    },
    /// There are several data files, and so perhaps several projects.
    #[error("there are several data files: {}; name the folder of one project", .0.join(", "))]
    SeveralDataFiles(Vec<String>),
    /// The data file cannot be read.
    #[error("{path} cannot be read: {reason}")]
    UnreadableDataFile {
        /// The file, from the project's folder on.
        path: String,
        /// Why.
        reason: String,
    },
    /// The project's files name different models of robots.
    #[error("the project's files do not agree on the robot: {}", said(.0))]
    Robots(Vec<RobotStatement>),
    /// The project's files name different flanges.
    #[error("the project's files do not agree on the robot's flange: {}", said(.0))]
    Flanges(Vec<RobotStatement>),
    /// The robot that is named is not built in.
    #[error("the robot is called `{0}`, which is no built-in model: its profile has to be given")]
    UnknownRobot(String),
    /// The length of the flange that is given is none.
    #[error("the flange: {0}")]
    FlangeLength(BadLength),
    /// The application ends without a motion.
    #[error("{}:{}: {} moves nothing", .application.file, .application.line, .application.name)]
    NoMotions {
        /// The application.
        application: Box<Application>,
    },
    /// What it does cannot be known before it runs.
    #[error("{}: {}", .0.source, .0.reason)]
    Refused(Box<RefusedImport>),
    /// The system gives no thread for the evaluation.
    #[error("the evaluation cannot begin: {0}")]
    Thread(String),
}

/// An application that cannot be planned ahead, as far as it was understood.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusedImport {
    /// The application.
    pub application: Application,
    /// Where the evaluation ended.
    pub source: Source,
    /// Why: a sentence without its capital and its full stop.
    pub reason: String,
    /// The motions up to there.
    pub understood: Program,
    /// The entries that the data file lacks, if it was refused for one of them.
    pub missing: Vec<Missing>,
    /// What is not as the sources have it.
    pub notes: Vec<ImportNote>,
    /// What it asked up to there, and how it was answered.
    pub questions: Vec<Question>,
    /// Questions without an answer that the reason depends on.
    pub unanswered: Vec<Unanswered>,
}

/// Something that an application asks for, and that has no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unanswered {
    /// Of which kind it is.
    pub kind: QuestionKind,
    /// As of a [`Question`].
    pub asked: String,
}

/// The first statements of a list, as text.
fn said(statements: &[RobotStatement]) -> String {
    const MOST: usize = 6;
    let mut said: Vec<_> = statements.iter().take(MOST).map(ToString::to_string).collect();
    if statements.len() > MOST {
        said.push(format!("and {} more", statements.len() - MOST));
    }
    said.join(", ")
}

/// The names of applications; with their files, which select them as well, where names alone are ambiguous.
fn names(applications: &[Application]) -> String {
    let name = |own: &Application| {
        let count = |is_same: &dyn Fn(&Application) -> bool| {
            applications.iter().filter(|other| is_same(other)).count()
        };
        if count(&|other| other.name == own.name) == 1 {
            own.name.clone()
        } else if count(&|other| other.qualified_name == own.qualified_name) == 1 {
            own.qualified_name.clone()
        } else {
            own.file.clone()
        }
    };
    let names: Vec<_> = applications.iter().map(name).collect();
    names.join(", ")
}
