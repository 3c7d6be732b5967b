//! Places of motions in program texts with repeat blocks.

use std::collections::BTreeMap;

use iiwa_json::JsonStep;
use serde_json::value::RawValue;

use crate::{motion_index::MotionIndex, repeat_block::MAX_REPEAT_DEPTH};

/// Path to a motion in the JSON text of a program or of a motion list. For a motion of a repeat
/// block, the path leads into the block, where the motion is written once.
///
/// Reads the text again: for error messages, not for hot paths.
///
/// ```
/// use iiwa_json::JsonStep::{Index, Key};
/// use iiwa_program::{MotionIndex, motion_path};
///
/// let text = r#"{ "motions": [
///     { "type": "wait", "seconds": 1 },
///     { "type": "repeat", "count": 3, "motions": [
///         { "type": "wait", "seconds": 2 }, { "type": "wait", "seconds": 3 } ] } ] }"#;
/// let sixth = MotionIndex::new(5);
/// let path = [Key("motions"), Index(1), Key("motions"), Index(0)];
/// assert_eq!(motion_path(text, sixth), path);
/// ```
#[must_use]
pub fn motion_path(text: &str, motion: MotionIndex) -> Vec<JsonStep<'static>> {
    let mut list = motions_in(text.trim()).unwrap_or_default();
    let (mut path, mut rest) = (Vec::new(), motion.index());
    for level in 0..=MAX_REPEAT_DEPTH {
        let mut entries = list.iter().enumerate().filter_map(|(index, raw)| {
            let length = size(raw.get(), level);
            // Entries before the motion are passed over.
            rest.checked_sub(length).map_or(Some((index, *raw)), |after| {
                rest = after;
                None
            })
        });
        // Without such an entry, the text has fewer motions than the program.
        let Some((index, entry)) = entries.next() else { break };
        path.extend([JsonStep::Key("motions"), JsonStep::Index(index)]);
        let Some((_, round)) = block_in(entry.get()) else { break };
        rest %= total(&round, level + 1).max(1);
        list = round;
    }
    if path.is_empty() {
        path.extend([JsonStep::Key("motions"), JsonStep::Index(motion.index())]);
    }
    path
}

/// Unparsed values of an object by key.
type EntryKeys<'a> = BTreeMap<String, &'a RawValue>;

fn motions_in(object: &str) -> Option<Vec<&RawValue>> {
    let keys: EntryKeys<'_> = serde_json::from_str(object).ok()?;
    serde_json::from_str(keys.get("motions")?.get()).ok()
}

/// Count and motions of a repeat block; `None` for another entry, or a block with errors.
fn block_in(entry: &str) -> Option<(usize, Vec<&RawValue>)> {
    // Most entries are motions, which need not be read: the type may contain escapes.
    if !entry.contains("repeat") && !entry.contains('\\') {
        return None;
    }
    let keys: EntryKeys<'_> = serde_json::from_str(entry).ok()?;
    let tag: String = serde_json::from_str(keys.get("type")?.get()).ok()?;
    let count = serde_json::from_str(keys.get("count")?.get()).ok().filter(|count| *count > 0)?;
    let motions = serde_json::from_str(keys.get("motions")?.get()).ok()?;
    (tag == "repeat").then_some((count, motions))
}

/// Number of motions of an entry, written out.
fn size(entry: &str, level: usize) -> usize {
    match block_in(entry) {
        Some((count, round)) if level < MAX_REPEAT_DEPTH => {
            total(&round, level + 1).saturating_mul(count)
        }
        _ => 1,
    }
}

/// Number of motions of a round, written out.
fn total(round: &[&RawValue], level: usize) -> usize {
    round.iter().map(|raw| size(raw.get(), level)).fold(0, usize::saturating_add)
}
