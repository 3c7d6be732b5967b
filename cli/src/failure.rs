//! How a command can fail, and how the failure is reported.

use std::{error::Error, io::Write as _, path::Path};

use iiwa_json::Place;
use iiwa_traj::{PlanError, TimingError};
use iiwa_view::{ViewError, printable, with_causes};
use miette::{Diagnostic, LabeledSpan, NamedSource, Report, SourceCode};

/// Why a command did not do what it was asked for.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input is not what it should be.
    Input(Report),
    /// It failed while running.
    Run { what: String, cause: Option<String> },
    /// It was done, but a gate was not met.
    Gate(String),
}

impl Failure {
    /// Input of which nothing can be shown.
    pub(crate) fn input(what: impl Into<String>) -> Self {
        let what = printable(&what.into());
        Self::Input(Report::new(Problem { what, text: None, place: None }))
    }

    /// A fault at a place in a text.
    pub(crate) fn in_text(what: &str, place: &Place, name: &str, text: &str) -> Self {
        Self::Input(Report::new(Problem {
            what: printable(&format!("{name}, {place}: {what}")),
            text: excerpt(text, place).then(|| NamedSource::new(printable(name), text.to_owned())),
            place: Some(place.clone()),
        }))
    }

    /// A program, called `name`, that cannot be planned.
    pub(crate) fn plan(error: PlanError, name: &str, text: &str) -> Self {
        match error {
            PlanError::Fault(fault) => {
                Self::in_text(&fault.to_string(), &fault.place_in(text), name, text)
            }
            PlanError::Timing(error @ TimingError::CurvatureJumps { .. }) => {
                Self::input(format!("{error} (--blend-shape iiwa, or --timing acceleration)"))
            }
            error => Self::run("cannot plan the program", &error),
        }
    }

    /// Something that went wrong on the way, and why.
    pub(crate) fn run(what: impl Into<String>, error: &dyn Error) -> Self {
        // It may have come over the network.
        Self::Run { what: printable(&what.into()), cause: Some(printable(&with_causes(error))) }
    }

    /// The same, with the program's name in front, unless the failure begins with it by itself.
    pub(crate) fn about(mut self, program: &str) -> Self {
        let program = printable(program);
        let what = match &mut self {
            Self::Input(report) => {
                report.downcast_mut::<Problem>().map(|problem| &mut problem.what)
            }
            Self::Run { what, .. } | Self::Gate(what) => Some(what),
        };
        if let Some(what) = what {
            let begins = what.strip_prefix("cannot read ").unwrap_or(what);
            let rest = begins.strip_prefix(&program);
            if !rest.is_some_and(|rest| rest.starts_with([',', ':', ' '])) {
                *what = format!("{program}: {what}");
            }
        }
        self
    }

    /// What went wrong, in one line.
    pub(crate) fn what(&self) -> String {
        match self {
            Self::Input(report) => report.to_string(),
            Self::Run { what, cause: Some(cause) } => format!("{what}: {cause}"),
            Self::Run { what, cause: None } | Self::Gate(what) => what.clone(),
        }
    }

    /// As it is reported on standard error.
    pub(crate) fn text(&self) -> String {
        let text = match self {
            Self::Input(report) => format!("{report:?}"),
            Self::Run { .. } => format!("Error: {}", self.what()),
            Self::Gate(what) => format!("Gate not met: {what}"),
        };
        format!("{}\n", text.trim_end())
    }

    /// Tells it on standard error.
    pub(crate) fn report(&self) {
        tell(&self.text());
    }
}

impl From<ViewError> for Failure {
    fn from(error: ViewError) -> Self {
        let hint = match &error {
            ViewError::UnknownRobot { .. } => "; name its profile with --robot",
            ViewError::Recording { name, .. }
                if Path::new(name).extension().is_some_and(|extension| extension == "json") =>
            {
                "; a program has to be planned first"
            }
            _ => "",
        };
        let what = format!("{}{hint}", with_causes(&error));
        if error.is_input() {
            Self::input(what)
        } else {
            Self::Run { what: printable(&what), cause: None }
        }
    }
}

/// Writes to standard error; if that is closed, nothing is written.
pub(crate) fn tell(text: &str) {
    let _ = anstream::stderr().write_all(text.as_bytes());
}

/// Whether the lines about a place are short enough to be shown, and harmless.
fn excerpt(text: &str, place: &Place) -> bool {
    const LONGEST_LINE: usize = 400;
    let from = text[..place.span.start].rfind('\n').map_or(0, |at| at + 1);
    let to = text[from..].lines().take(3).map(str::len).max().unwrap_or(0);
    let before = text[..from].trim_end_matches('\n').rsplit('\n').next().map_or(0, str::len);
    let obeyed = |c: char| c.is_control() && !c.is_whitespace();
    to <= LONGEST_LINE && before <= LONGEST_LINE && !text.contains(obeyed)
}

#[derive(Debug, thiserror::Error)]
#[error("{what}")]
struct Problem {
    what: String,
    text: Option<NamedSource<String>>,
    place: Option<Place>,
}

impl Diagnostic for Problem {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.text.as_ref().map(|text| text as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.place.as_ref().filter(|_| self.text.is_some())?;
        // A whole object is shown by where it begins.
        let span = place.span.start..place.span.end.min(place.span.start + 60);
        Some(Box::new(std::iter::once(LabeledSpan::at(span, "here"))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_others_say_does_not_reach_the_terminal_as_commands() {
        let error = std::io::Error::other("\u{1b}[2J\u{9b}31m gone\r\n");
        let failures = [Failure::run("cannot ask", &error), Failure::input(error.to_string())];
        for text in failures.map(|failure| failure.text()) {
            assert!(!text.trim_end().contains(|c: char| c.is_control() && c != '\n'), "{text:?}");
            assert!(text.contains("[2J"), "{text}");
        }
    }
}
