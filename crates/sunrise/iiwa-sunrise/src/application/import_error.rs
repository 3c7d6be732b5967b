//! Errors of importing an application.

use crate::{DataFileError, Question, QuestionKind, RobotStatement, SourceError};
use iiwa_kin::BadLength;
use iiwa_program::{Program, Source};

use crate::application::{applications::Application, import_note::ImportNote, missing::Missing};

/// Error of importing an application.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The project has no applications.
    #[error(
        "no application found in the project's {files} Java files: none of their classes extends \
         RoboticsAPIApplication"
    )]
    NoApplications {
        /// Number of files that were read.
        files: usize,
    },
    /// The project has several applications, and none was named.
    #[error("the project has several applications: {}; name one of them", names(.known))]
    Several {
        /// Applications of the project.
        known: Vec<Application>,
    },
    /// No application has this name.
    #[error("the project has no application `{name}`; it has {}", names(.known))]
    Unknown {
        /// Requested name.
        name: String,
        /// Applications of the project.
        known: Vec<Application>,
    },
    /// A required source file cannot be used.
    #[error(transparent)]
    Source(SourceError),
    /// The data file cannot be used.
    #[error("{path}: {fault}")]
    DataFile {
        /// Path of the file, relative to the project folder.
        path: String,
        /// Fault of the file.
        fault: DataFileError,
    },
    /// Several data files exist, possibly of several projects.
    #[error("there are several data files: {}; name the folder of one project", .0.join(", "))]
    SeveralDataFiles(Vec<String>),
    /// The data file cannot be read.
    #[error("{path} cannot be read: {reason}")]
    UnreadableDataFile {
        /// Path of the file, relative to the project folder.
        path: String,
        /// Reason.
        reason: String,
    },
    /// The project's files name different robot models.
    #[error("the project's files do not agree on the robot: {}", listed(.0))]
    Robots(Vec<RobotStatement>),
    /// The project's files name different flanges.
    #[error("the project's files do not agree on the robot's flange: {}", listed(.0))]
    Flanges(Vec<RobotStatement>),
    /// The named robot is not a built-in model.
    #[error(
        "the robot is called `{0}`, which is not a built-in model: its profile has to be given"
    )]
    UnknownRobot(String),
    /// The given flange length is not valid.
    #[error("the flange: {0}")]
    FlangeLength(BadLength),
    /// The application ends without a motion.
    #[error("{}:{}: {} has no motions", .application.file, .application.line, .application.name)]
    NoMotions {
        /// Application.
        application: Box<Application>,
    },
    /// The motions of the application cannot be known before run time.
    #[error("{}: {}", .0.source, .0.reason)]
    Refused(Box<RefusedImport>),
    /// The system cannot start a thread for the evaluation.
    #[error("the evaluation cannot begin: {0}")]
    Thread(String),
}

/// Application that cannot be planned offline, with its evaluation up to there.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusedImport {
    /// Application.
    pub application: Application,
    /// Place at which the evaluation ended.
    pub source: Source,
    /// Reason: a sentence without its capital and its full stop.
    pub reason: String,
    /// Motions up to that place.
    pub understood: Program,
    /// Entries that the data file lacks, if one of them is the reason.
    pub missing: Vec<Missing>,
    /// Differences between the program and the sources.
    pub notes: Vec<ImportNote>,
    /// Questions up to that place, with their answers.
    pub questions: Vec<Question>,
    /// Unanswered questions on which the reason depends.
    pub unanswered: Vec<Unanswered>,
}

/// Unanswered question of an application.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unanswered {
    /// Kind of the question.
    pub kind: QuestionKind,
    /// Subject, as in a [`Question`].
    pub subject: String,
}

/// Formats the first statements of a list.
fn listed(statements: &[RobotStatement]) -> String {
    const MAX_STATEMENTS: usize = 6;
    let mut listed: Vec<_> =
        statements.iter().take(MAX_STATEMENTS).map(ToString::to_string).collect();
    if statements.len() > MAX_STATEMENTS {
        listed.push(format!("and {} more", statements.len() - MAX_STATEMENTS));
    }
    listed.join(", ")
}

/// Formats the names of applications; ambiguous names with their package, or as files, which select
/// applications as well.
fn names(applications: &[Application]) -> String {
    let name = |application: &Application| {
        let count = |is_same: &dyn Fn(&Application) -> bool| {
            applications.iter().filter(|other| is_same(other)).count()
        };
        if count(&|other| other.name == application.name) == 1 {
            application.name.clone()
        } else if count(&|other| other.qualified_name == application.qualified_name) == 1 {
            application.qualified_name.clone()
        } else {
            application.file.clone()
        }
    };
    let names: Vec<_> = applications.iter().map(name).collect();
    names.join(", ")
}
