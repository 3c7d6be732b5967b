//! JSON form of repeat blocks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::notes::{COMMENT_PATTERN, NAME_PATTERN};
use crate::motion_label::MotionLabel;

/// Type of a block in JSON.
pub(super) const REPEAT: &str = "repeat";

#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(inline)]
enum RepeatTag {
    #[serde(rename = "repeat")]
    Repeat,
}

/// A block of motions that are repeated. `M` is the type of its entries.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Repeat")]
pub(super) struct RepeatWire<M> {
    r#type: RepeatTag,
    /// Number of rounds. Written out, all blocks of a program have at most 100000 motions, spline
    /// segments and load shapes.
    #[schemars(range(min = 1, max = 100_000))]
    pub(super) count: u64,
    /// Motions of a round in order, and further blocks, which may be nested 8 deep.
    #[schemars(length(min = 1))]
    pub(super) motions: Vec<M>,
    /// Name of the block, for tables and reports, without control characters; need not be unique.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1, max = 200), regex(pattern = NAME_PATTERN))]
    name: Option<String>,
    /// Comment on the block, for reports.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(max = 2000), regex(pattern = COMMENT_PATTERN))]
    comment: Option<String>,
    /// Group of all motions in the block that state no group.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1, max = 200), regex(pattern = NAME_PATTERN))]
    group: Option<String>,
}

impl<M> RepeatWire<M> {
    pub(super) fn new(count: usize, label: MotionLabel, motions: Vec<M>) -> Self {
        let MotionLabel { name, comment, group } = label;
        Self { r#type: RepeatTag::Repeat, count: count as u64, motions, name, comment, group }
    }

    pub(super) fn label(&self) -> MotionLabel {
        let Self { name, comment, group, .. } = self;
        MotionLabel { name: name.clone(), comment: comment.clone(), group: group.clone() }
    }
}
