//! Program texts.

use std::sync::Arc;

use iiwa_program::{Program, ProgramError};

/// Text of a program. Clones share the memory.
#[derive(Clone, Debug)]
pub struct ProgramText {
    text: Arc<str>,
    /// Text merged with the included file, if any.
    merged: Option<Arc<str>>,
}

impl ProgramText {
    /// Creates the text of a program from the program's file and the included file.
    pub(crate) fn new(text: &str, included: Option<&str>) -> Result<Self, ProgramError> {
        let merged = included.map(|file| Program::merged_json(text, file)).transpose()?;
        Ok(Self { text: text.into(), merged: merged.map(Arc::from) })
    }

    /// Text as read; places in errors refer to it.
    #[must_use]
    pub fn as_read(&self) -> &str {
        &self.text
    }

    /// Text as stored and sent: merged with the included file, so that it needs no other file.
    #[must_use]
    pub fn complete(&self) -> &str {
        self.merged.as_deref().unwrap_or(&self.text)
    }
}

/// Converts a text that includes no file.
impl From<String> for ProgramText {
    fn from(text: String) -> Self {
        Self { text: text.into(), merged: None }
    }
}
