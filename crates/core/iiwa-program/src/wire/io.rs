//! JSON form of inputs and outputs.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::{
    notes::{NAME_PATTERN, noted_wire},
    wait::{in_keys, of_keys},
};
use crate::{
    io_entry::{IoEntry, IoKind, MAX_IO_NAME},
    io_value::IoValue,
    program::Motion,
};

/// JSON Schema of the name of an input or output.
fn name_schema(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "string", "minLength": 1, "maxLength": MAX_IO_NAME, "pattern": NAME_PATTERN
    })
}

/// JSON Schema of the value of an input or output.
fn value_schema(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": ["boolean", "number"] })
}

#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(inline)]
enum SetTag {
    #[serde(rename = "set")]
    Set,
}

#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(inline)]
enum WaitForTag {
    #[serde(rename = "wait_for")]
    WaitFor,
}

noted_wire! {
/// Sets an output, which takes no time: at rest, or during motion if the entry overlaps motions.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    rename = "Set",
    extend("not" = {"required": ["overlap", "overlap_motions"]})
)]
pub(super) struct SetWire {
    r#type: SetTag,
    /// Name of the output, `Group.Signal` on a Sunrise controller.
    #[schemars(schema_with = "name_schema")]
    io: String,
    /// New value of the output.
    #[schemars(schema_with = "value_schema")]
    value: IoValue,
    /// `true` if the output is set while the robot moves: at the start of the motion before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "bool")]
    overlap: Option<bool>,
    /// Number of motions to overlap: the output is set at the start of the motion that many before
    /// the entry; 1 is the same as `overlap`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "usize", range(min = 1, max = 1000))]
    overlap_motions: Option<usize>,
}
}

noted_wire! {
/// Waits until an input has a value: at rest, or during motion if the entry overlaps motions. The
/// plan assumes a time for it.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    rename = "WaitFor",
    extend("not" = {"required": ["overlap", "overlap_motions"]})
)]
pub(super) struct WaitForWire {
    r#type: WaitForTag,
    /// Name of the input, `Group.Signal` on a Sunrise controller; an output, too, can be read.
    #[schemars(schema_with = "name_schema")]
    io: String,
    /// Value that the program waits for.
    #[schemars(schema_with = "value_schema")]
    value: IoValue,
    /// Assumed time until the input has the value, in s: at most a day.
    #[schemars(range(min = 0, max = 86_400))]
    seconds: f64,
    /// `true` if the time runs while the robot moves: from the start of the motion before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "bool")]
    overlap: Option<bool>,
    /// Number of motions to overlap: the time runs from the start of the motion that many before
    /// the entry; 1 is the same as `overlap`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "usize", range(min = 1, max = 1000))]
    overlap_motions: Option<usize>,
}
}

impl SetWire {
    fn new(entry: &IoEntry) -> Self {
        let (overlap, overlap_motions) = in_keys(entry.overlap);
        Self {
            r#type: SetTag::Set,
            io: entry.io.clone(),
            value: entry.value,
            overlap,
            overlap_motions,
            name: None,
            comment: None,
            group: None,
            source: None,
        }
    }

    pub(super) fn motion(self) -> Result<Motion, (&'static str, String)> {
        let Self { io, value, overlap, overlap_motions, .. } = self;
        let overlap = of_keys(overlap, overlap_motions)?;
        Ok(Motion::Io(IoEntry { io, value, kind: IoKind::Set, overlap }))
    }
}

impl WaitForWire {
    fn new(entry: &IoEntry, seconds: f64) -> Self {
        let (overlap, overlap_motions) = in_keys(entry.overlap);
        Self {
            r#type: WaitForTag::WaitFor,
            io: entry.io.clone(),
            value: entry.value,
            seconds,
            overlap,
            overlap_motions,
            name: None,
            comment: None,
            group: None,
            source: None,
        }
    }

    pub(super) fn motion(self) -> Result<Motion, (&'static str, String)> {
        let Self { io, value, seconds, overlap, overlap_motions, .. } = self;
        let overlap = of_keys(overlap, overlap_motions)?;
        Ok(Motion::Io(IoEntry { io, value, kind: IoKind::WaitFor { seconds }, overlap }))
    }
}

/// JSON form of an entry with an input or output.
pub(super) enum IoWire {
    Set(SetWire),
    WaitFor(WaitForWire),
}

impl From<&IoEntry> for IoWire {
    fn from(entry: &IoEntry) -> Self {
        match entry.kind {
            IoKind::Set => Self::Set(SetWire::new(entry)),
            IoKind::WaitFor { seconds } => Self::WaitFor(WaitForWire::new(entry, seconds)),
        }
    }
}
