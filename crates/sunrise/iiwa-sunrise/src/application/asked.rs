//! Questions of an application, in the order of their evaluation.

use crate::QuestionKind;
use iiwa_java::SourceLine;

/// One occurrence of a question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Asked {
    pub(crate) kind: QuestionKind,
    /// Text of the dialog, or name of the requested value.
    pub(crate) subject: String,
    /// Button names of the dialog.
    pub(crate) choices: Vec<String>,
    /// Answer; `None` if it is unknown.
    pub(crate) answer: Option<String>,
    pub(crate) is_given: bool,
}

/// Loop that never ends with the given answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct EndlessLoop {
    pub(crate) place: SourceLine,
    /// Dialogs of its last iteration.
    pub(crate) dialogs: Vec<Asked>,
}
