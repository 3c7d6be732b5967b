//! Steps of the check, and their faults.

use std::fmt;

use serde::Serialize;

/// Result of a step of a [`LinkCheck`](super::LinkCheck).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StepResult {
    /// The check has passed.
    Ok,
    /// A fault was found.
    Fails,
    /// The check was not possible.
    Skipped,
}

impl fmt::Display for StepResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Ok => "ok",
            Self::Fails => "fails",
            Self::Skipped => "skipped",
        })
    }
}

/// A step of a [`LinkCheck`](super::LinkCheck).
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct CheckStep {
    /// Name of the step.
    pub step: &'static str,
    /// Result of the step.
    pub result: StepResult,
    /// Finding and remedy, as text for people.
    pub text: String,
    /// The drive settings that may be wrong, by the names of the command-line options.
    #[serde(skip_serializing_if = "<[&str]>::is_empty")]
    pub settings: &'static [&'static str],
}

impl CheckStep {
    /// Formats the step as a line, with `mark` before the setting names.
    #[must_use]
    pub fn line(&self, mark: &str) -> String {
        let Self { step, result, text, settings } = self;
        let settings: Vec<_> = settings.iter().map(|name| format!("{mark}{name}")).collect();
        let settings = match settings.as_slice() {
            [] => String::new(),
            settings => format!(" ({})", settings.join(", ")),
        };
        format!("{result:<8}{step:<20}{text}{settings}")
    }
}

/// A fault, and the settings that may be wrong.
pub(super) struct LinkFault {
    pub(super) text: String,
    pub(super) settings: &'static [&'static str],
}

impl LinkFault {
    pub(super) fn new(text: impl Into<String>, settings: &'static [&'static str]) -> Self {
        Self { text: text.into(), settings }
    }
}
