//! JSON form of waits.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::source::SourceWire;
use crate::program::Motion;

#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(inline)]
enum WaitTag {
    #[serde(rename = "wait")]
    Wait,
}

/// A wait at rest, or during motion if the wait overlaps motions.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    rename = "Wait",
    extend("not" = {"required": ["overlap", "overlap_motions"]})
)]
pub(super) struct WaitWire {
    r#type: WaitTag,
    /// Duration, in s: at most a day.
    #[schemars(range(min = 0, max = 86_400))]
    seconds: f64,
    /// `true` if the time runs while the robot moves: from the start of the motion before the wait.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "bool")]
    overlap: Option<bool>,
    /// Number of motions to overlap: the time runs from the start of the motion that many before
    /// the wait; 1 is the same as `overlap`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "usize", range(min = 1, max = 1000))]
    overlap_motions: Option<usize>,
    /// Source line of the motion.
    #[serde(
        default,
        deserialize_with = "iiwa_json::object_or_null",
        skip_serializing_if = "Option::is_none"
    )]
    pub(super) source: Option<SourceWire>,
}

impl WaitWire {
    pub(super) fn new(seconds: f64, overlap: usize) -> Self {
        Self {
            r#type: WaitTag::Wait,
            seconds,
            overlap: (overlap == 1).then_some(true),
            overlap_motions: (overlap > 1).then_some(overlap),
            source: None,
        }
    }

    pub(super) fn motion(self) -> Result<Motion, (&'static str, String)> {
        let wrong = |message: &str| Err(("overlap_motions", message.to_owned()));
        let overlap = match (self.overlap, self.overlap_motions) {
            (Some(_), Some(_)) => return wrong("give either `overlap` or `overlap_motions`"),
            (_, Some(0)) => return wrong("overlap_motions must be at least 1"),
            (_, Some(motions)) => motions,
            (Some(true), None) => 1,
            (Some(false) | None, None) => 0,
        };
        Ok(Motion::Wait { seconds: self.seconds, overlap })
    }
}
