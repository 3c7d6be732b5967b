//! Failures of commands, and their reports.

use std::{error::Error, io::Write as _, ops::Range, path::Path};

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use iiwa_files::{OutputError, folder_of, interrupt};
use iiwa_json::{JsonPlace, further_errors, printable, without_mark};
use iiwa_page::PageError;
use iiwa_program::{MAX_ERRORS, ProgramError};
#[cfg(feature = "live")]
use iiwa_report::ExperimentError;
use iiwa_report::{ErrorRecord, PictureError, ProgramErrors, with_causes};
use iiwa_traj::{PlanError, TimingError};

use crate::file_kind::{JsonKind, other_kind};

/// Reason why a command failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input is invalid.
    Input(Vec<Problem>),
    /// The command failed at run time.
    Run { message: String, cause: Option<String> },
    /// The command succeeded, but a gate was violated.
    Gate(String),
}

impl Failure {
    /// Creates a failure for invalid input, without an excerpt.
    pub(crate) fn input(message: impl Into<String>) -> Self {
        let message = printable(&message.into());
        Self::Input(vec![Problem { message, placed: None, excerpt: None }])
    }

    /// Creates a failure for a fault at a place in a text.
    pub(crate) fn in_text(message: &str, place: &JsonPlace, name: &str, text: &str) -> Self {
        // Places are counted from behind a byte order mark.
        let text = without_mark(text);
        // Only the beginning of a long object is marked.
        let Range { start, end } = place.span;
        let is_boundary = |byte: &usize| text.is_char_boundary(*byte);
        let end = (start..=end.min(start + 60)).rev().find(is_boundary).unwrap_or(start);
        let marked = start..end;
        let excerpt = can_be_shown(text, place).then(|| Excerpt {
            name: printable(name),
            text: text.to_owned(),
            marked,
        });
        let JsonPlace { line, column, .. } = place;
        let placed = ErrorRecord {
            file: Some(name.to_owned()),
            line: Some(*line),
            column: Some(*column),
            message: message.to_owned(),
        };
        let message = printable(&format!("{name}, {place}: {message}"));
        Self::Input(vec![Problem { message, placed: Some(placed), excerpt }])
    }

    /// Converts the error of a program called `name` that cannot be read from `text` or planned.
    pub(crate) fn program(error: &iiwa_plan::Error, name: &str, text: &str) -> Self {
        use iiwa_plan::Error;
        match error {
            Error::Several(errors) => {
                Self::several(errors.iter().map(|error| Self::program(error, name, text)))
            }
            Error::Program(ProgramError::Included { name: included, text, error, .. }) => {
                let file = folder_of(Path::new(name)).join(included).display().to_string();
                Self::in_text(&error.message(), error.place(), &file, text)
            }
            Error::Profile { file, text, error } => {
                other_kind(file, text, JsonKind::Profile, "robot profile").map_or_else(
                    || Self::in_text(&error.message(), error.place(), file, text),
                    Self::input,
                )
            }
            Error::UnknownRobot { place, .. } => {
                let message = format!("{}; --robot accepts any other robot", error.message());
                Self::in_text(&message, place, name, text)
            }
            Error::Plan { error: plan, .. } => match &**plan {
                PlanError::Timing(TimingError::Interrupted) => Self::interrupted(),
                PlanError::Timing(error @ TimingError::CurvatureJumps { .. }) => {
                    Self::input(format!("{error} (--blend-shape iiwa, or --timing acceleration)"))
                }
                PlanError::Fault(_) | PlanError::Timing(TimingError::CannotHold { .. }) => {
                    Self::at_place(error, name, text)
                }
                plan => Self::run("cannot plan the program", plan),
            },
            error => Self::at_place(error, name, text),
        }
    }

    /// Converts an error in the text of a program, with its place if known.
    fn at_place(error: &iiwa_plan::Error, name: &str, text: &str) -> Self {
        match error.place() {
            Some(place) => Self::in_text(&error.message(), place, name, text),
            None => Self::input(error.to_string()),
        }
    }

    /// Creates a failure from several failures that are independent of each other.
    pub(crate) fn several(failures: impl Iterator<Item = Self>) -> Self {
        Self::Input(failures.flat_map(Self::into_problems).collect())
    }

    fn into_problems(self) -> Vec<Problem> {
        match self {
            Self::Input(problems) => problems,
            other => vec![Problem { message: other.message(), placed: None, excerpt: None }],
        }
    }

    /// Creates the failure for an interrupt.
    pub(crate) fn interrupted() -> Self {
        Self::Run { message: "interrupted".to_owned(), cause: None }
    }

    /// Creates a run-time failure with its cause.
    pub(crate) fn run(message: impl Into<String>, error: &dyn Error) -> Self {
        // Parts may have been received over the network.
        Self::Run {
            message: printable(&message.into()),
            cause: Some(printable(&with_causes(error))),
        }
    }

    /// Creates a run-time failure whose error names the failed operation.
    pub(crate) fn broken(error: &dyn Error) -> Self {
        Self::Run { message: printable(&with_causes(error)), cause: None }
    }

    /// Adds the name of the program as a prefix, unless the text begins with it already.
    pub(crate) fn about(mut self, program: &str) -> Self {
        let program = printable(program);
        let messages = match &mut self {
            Self::Input(problems) => problems.iter_mut().map(|it| &mut it.message).collect(),
            Self::Run { message, .. } | Self::Gate(message) => vec![message],
        };
        for message in messages {
            let begins = message.strip_prefix("cannot read ").unwrap_or(message);
            let rest = begins.strip_prefix(&program);
            if !rest.is_some_and(|rest| rest.starts_with([',', ':', ' '])) {
                *message = format!("{program}: {message}");
            }
        }
        self
    }

    /// Formats the failure in one line.
    pub(crate) fn message(&self) -> String {
        match self {
            Self::Input(problems) => {
                let [first, others @ ..] = problems.as_slice() else { return String::new() };
                format!("{}{}", first.message, further_errors(others.len()))
            }
            Self::Run { message, cause: Some(cause) } => format!("{message}: {cause}"),
            Self::Run { message, cause: None } | Self::Gate(message) => message.clone(),
        }
    }

    /// Returns the errors for JSON output.
    pub(crate) fn errors(&self) -> ProgramErrors {
        let placeless =
            |message: String| ErrorRecord { file: None, line: None, column: None, message };
        let errors = match self {
            Self::Input(problems) => problems
                .iter()
                .map(|it| it.placed.clone().unwrap_or_else(|| placeless(it.message.clone())))
                .collect(),
            _ => vec![placeless(self.message())],
        };
        ProgramErrors { error: self.message(), errors }
    }

    /// Formats the failure for standard error.
    pub(crate) fn text(&self) -> String {
        let text = match self {
            Self::Input(problems) => {
                let mut texts: Vec<_> = problems.iter().map(Problem::text).collect();
                if problems.len() == MAX_ERRORS {
                    texts.push(format!("These are {MAX_ERRORS} errors; there may be more."));
                }
                texts.join("\n")
            }
            Self::Run { .. } => format!("Error: {}", self.message()),
            Self::Gate(condition) => format!("Gate not met: {condition}"),
        };
        format!("{}\n", text.trim_end())
    }
}

impl From<PageError> for Failure {
    fn from(error: PageError) -> Self {
        Self::from(&error)
    }
}

impl From<&PageError> for Failure {
    fn from(error: &PageError) -> Self {
        // An interrupt makes reading from a pipe fail.
        if interrupt::has_come() {
            return Self::interrupted();
        }
        let hint = match error {
            PageError::UnknownRobot { .. } => "; name its profile with --robot",
            PageError::Recording { name, .. }
                if Path::new(name).extension().is_some_and(|extension| extension == "json") =>
            {
                "; a program has to be planned first"
            }
            _ => "",
        };
        if error.is_input() {
            Self::input(format!("{}{hint}", with_causes(error)))
        } else {
            Self::broken(error)
        }
    }
}

impl From<PictureError> for Failure {
    fn from(error: PictureError) -> Self {
        Self::broken(&error)
    }
}

#[cfg(feature = "live")]
impl From<ExperimentError> for Failure {
    fn from(error: ExperimentError) -> Self {
        if error.is_input() { Self::input(with_causes(&error)) } else { Self::broken(&error) }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::from(&error)
    }
}

impl From<&OutputError> for Failure {
    fn from(error: &OutputError) -> Self {
        match error {
            OutputError::Interrupted => Self::interrupted(),
            OutputError::Write { .. } => Self::broken(error),
        }
    }
}

/// Prints to standard error, which may be closed.
pub(crate) fn print_note(text: &str) {
    let _ = anstream::stderr().write_all(text.as_bytes());
}

/// Returns true if the lines around a place can be shown: short, without control characters.
fn can_be_shown(text: &str, place: &JsonPlace) -> bool {
    const MAX_LINE: usize = 400;
    let from = text[..place.span.start].rfind('\n').map_or(0, |newline| newline + 1);
    let to = text[from..].lines().take(3).map(str::len).max().unwrap_or(0);
    let before = text[..from].trim_end_matches('\n').rsplit('\n').next().map_or(0, str::len);
    let is_control = |c: char| c.is_control() && !c.is_whitespace();
    to <= MAX_LINE && before <= MAX_LINE && !text.contains(is_control)
}

/// Invalid input.
#[derive(Debug)]
pub(crate) struct Problem {
    message: String,
    /// Error with its place, if it is in a text.
    placed: Option<ErrorRecord>,
    excerpt: Option<Excerpt>,
}

/// Excerpt of a text with the fault.
#[derive(Debug)]
struct Excerpt {
    name: String,
    text: String,
    /// Marked range of bytes in the text.
    marked: Range<usize>,
}

impl Problem {
    /// Formats the problem with the line and a mark under the place, in colours, which
    /// [`print_note`] strips if standard error is not a terminal.
    fn text(&self) -> String {
        let title = Level::ERROR.with_name("Error").primary_title(&self.message);
        let report = match &self.excerpt {
            None => Group::with_title(title),
            Some(Excerpt { name, text, marked }) => title.element(
                Snippet::source(text)
                    .path(name)
                    .annotation(AnnotationKind::Primary.span(marked.clone()).label("here")),
            ),
        };
        Renderer::styled().render(&[report])
    }
}
