//! JSON form of motion sources.

use iiwa_json::{JsonObject, object_or_null};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::source::Source;

/// Source line of the motion, for messages.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Source")]
pub(super) struct SourceWire {
    /// File name.
    file: String,
    /// Line number, from 1.
    #[schemars(range(min = 1))]
    line: u32,
}

impl SourceWire {
    pub(super) fn source(self) -> Result<Source, &'static str> {
        match self {
            Self { line: 0, .. } => Err("the first line of a source is line 1"),
            Self { file, line } => Ok(Source { file, line }),
        }
    }
}

impl From<&Source> for SourceWire {
    fn from(Source { file, line }: &Source) -> Self {
        Self { file: file.clone(), line: *line }
    }
}

/// Source of a motion that is otherwise unreadable.
pub(super) fn source_in(motion: &str) -> Option<Source> {
    #[derive(Deserialize)]
    struct Sourced {
        #[serde(default, deserialize_with = "object_or_null")]
        source: Option<SourceWire>,
    }
    let JsonObject(Sourced { source }) = serde_json::from_str(motion).ok()?;
    source?.source().ok()
}
