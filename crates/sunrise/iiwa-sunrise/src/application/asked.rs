//! Questions of an application, in the order in which it asks them.

use crate::QuestionKind;
use iiwa_java::Place;

/// A question, each time that it was asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Asked {
    pub(crate) kind: QuestionKind,
    /// The text of the dialog, or the name of what is asked for.
    pub(crate) subject: String,
    /// The names of the dialog's buttons.
    pub(crate) choices: Vec<String>,
    /// None if it is not known.
    pub(crate) answer: Option<String>,
    pub(crate) is_given: bool,
}

/// A loop that goes on for ever by the answers that it got.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct EndlessLoop {
    pub(crate) place: Place,
    /// The dialogs of its last turn.
    pub(crate) dialogs: Vec<Asked>,
}
