//! Completion of statements.

use crate::value::Value;

#[derive(Debug)]
pub(crate) enum Flow {
    /// Normal completion.
    Next,
    /// `break`, with its label if any.
    Break(Option<String>),
    /// `continue`, with its label if any.
    Continue(Option<String>),
    /// `yield`.
    Yield(Value),
    /// `return`.
    Return(Value),
}
