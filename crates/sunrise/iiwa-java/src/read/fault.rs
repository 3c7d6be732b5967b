//! Fault at an offset of a text.

use crate::source_error::SourceFault;

/// Fault with its byte offset.
#[derive(Debug)]
pub(super) struct SyntaxFault {
    pub(super) offset: usize,
    pub(super) error: SourceFault,
}

impl SyntaxFault {
    pub(super) fn syntax(offset: usize, message: impl Into<String>) -> Self {
        Self { offset, error: SourceFault::Syntax(message.into()) }
    }

    pub(super) fn too_deep(offset: usize, excess: &'static str, max_depth: usize) -> Self {
        Self { offset, error: SourceFault::TooDeep { excess, max_depth } }
    }
}
