//! Texts of programs.

use std::sync::Arc;

use iiwa_program::{Program, ProgramError};

/// The text of a program. Clones share it.
#[derive(Clone, Debug)]
pub struct ProgramText {
    text: Arc<str>,
    /// The text with what it includes, if it includes anything.
    merged: Option<Arc<str>>,
}

impl ProgramText {
    /// The text of a program, and that of the file which it includes.
    pub(crate) fn new(text: &str, included: Option<&str>) -> Result<Self, ProgramError> {
        let merged = included.map(|file| Program::merged_json(text, file)).transpose()?;
        Ok(Self { text: text.into(), merged: merged.map(Arc::from) })
    }

    /// The text as it was read: places in errors are places in it.
    #[must_use]
    pub fn as_read(&self) -> &str {
        &self.text
    }

    /// The text as it is stored and sent: with what it includes, so that it needs no other file.
    #[must_use]
    pub fn complete(&self) -> &str {
        self.merged.as_deref().unwrap_or(&self.text)
    }
}

/// A text that includes no file.
impl From<String> for ProgramText {
    fn from(text: String) -> Self {
        Self { text: text.into(), merged: None }
    }
}
