//! Fault at an offset of a text.

use crate::source_error::SourceFault;

/// Fault with its byte offset.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) at: usize,
    pub(super) what: SourceFault,
}

impl Fault {
    pub(super) fn syntax(at: usize, what: impl Into<String>) -> Self {
        Self { at, what: SourceFault::Syntax(what.into()) }
    }

    pub(super) fn too_deep(at: usize, what: &'static str, most: usize) -> Self {
        Self { at, what: SourceFault::TooDeep { what, most } }
    }
}
