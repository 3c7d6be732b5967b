//! Reasons to stop an evaluation.

use std::rc::Rc;

use crate::{place::SourceLine, value::Thrown};

/// Reason why an expression has no value.
#[derive(Debug)]
pub enum EvaluationStop {
    /// Java exception, which the program may catch.
    Thrown(Rc<Thrown>),
    /// Endless loop of the application: the code after the loop is not reached.
    Ended,
    /// Code that cannot be planned offline: the whole application is refused.
    Refused(Box<JavaRefusal>),
}

/// Refusal of an application.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JavaRefusal {
    /// Sentence without its capital and its full stop.
    pub reason: String,
    /// Place at which the evaluation ended.
    pub place: SourceLine,
}
