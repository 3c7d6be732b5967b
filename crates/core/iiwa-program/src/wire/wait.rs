//! JSON form of waits, and of the keys `overlap` and `overlap_motions`, which inputs and outputs
//! also have.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::notes::noted_wire;
use crate::program::Motion;

#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(inline)]
enum WaitTag {
    #[serde(rename = "wait")]
    Wait,
}

noted_wire! {
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
}
}

impl WaitWire {
    pub(super) fn new(seconds: f64, overlap: usize) -> Self {
        let (overlap, overlap_motions) = in_keys(overlap);
        Self {
            r#type: WaitTag::Wait,
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
        let overlap = of_keys(self.overlap, self.overlap_motions)?;
        Ok(Motion::Wait { seconds: self.seconds, overlap })
    }
}

/// Returns the number of overlapped motions, or the key at fault and the reason.
pub(super) fn of_keys(
    overlap: Option<bool>,
    overlap_motions: Option<usize>,
) -> Result<usize, (&'static str, String)> {
    let wrong = |message: &str| Err(("overlap_motions", message.to_owned()));
    match (overlap, overlap_motions) {
        (Some(_), Some(_)) => wrong("give either `overlap` or `overlap_motions`"),
        (_, Some(0)) => wrong("overlap_motions must be at least 1"),
        (_, Some(motions)) => Ok(motions),
        (Some(true), None) => Ok(1),
        (Some(false) | None, None) => Ok(0),
    }
}

/// Values of the two keys for a number of overlapped motions.
pub(super) fn in_keys(overlap: usize) -> (Option<bool>, Option<usize>) {
    ((overlap == 1).then_some(true), (overlap > 1).then_some(overlap))
}
