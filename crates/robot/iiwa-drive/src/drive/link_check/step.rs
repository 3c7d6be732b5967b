//! Steps of the check, and what is wrong in them.

use std::fmt;

use serde::Serialize;

/// How a step of a [`LinkCheck`](super::LinkCheck) went.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StepResult {
    /// All is right.
    Ok,
    /// Something is wrong.
    Fails,
    /// It could not be told.
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
    /// What is checked.
    pub step: &'static str,
    /// How it went.
    pub result: StepResult,
    /// What was found, and what to do about it, for people.
    pub text: String,
    /// The settings of the drive that may be wrong, by the names of the command's options.
    #[serde(skip_serializing_if = "<[&str]>::is_empty")]
    pub settings: &'static [&'static str],
}

impl CheckStep {
    /// The step as a line, with `mark` before the names of settings.
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

/// What is wrong, and the settings that may be.
pub(super) struct Fault {
    pub(super) text: String,
    pub(super) settings: &'static [&'static str],
}

impl Fault {
    pub(super) fn new(text: impl Into<String>, settings: &'static [&'static str]) -> Self {
        Self { text: text.into(), settings }
    }
}
