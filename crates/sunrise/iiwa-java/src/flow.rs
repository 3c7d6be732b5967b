//! How a statement ends.

use crate::value::Value;

#[derive(Debug)]
pub(crate) enum Flow {
    /// With the next statement.
    Next,
    /// By `break`, with its label if it has one.
    Break(Option<String>),
    /// By `continue`, likewise.
    Continue(Option<String>),
    /// By `yield`.
    Yield(Value),
    /// By `return`.
    Return(Value),
}
