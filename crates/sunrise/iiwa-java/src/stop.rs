//! Why an evaluation goes no further.

use std::rc::Rc;

use crate::{place::Place, value::Thrown};

/// Why an expression has no value.
#[derive(Debug)]
pub enum Stop {
    /// An exception of Java, which the program may catch.
    Thrown(Rc<Thrown>),
    /// The application goes on for ever as it did: what follows is not reached.
    Ended,
    /// What cannot be planned ahead: the whole application is refused.
    Refused(Box<Refusal>),
}

/// Why an application is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// A sentence without its capital and its full stop.
    pub reason: String,
    /// Where the evaluation ended.
    pub place: Place,
}
