//! Places of unknown names.

use iiwa_json::{JsonPlace, JsonStep, locate};
use serde_json::Value;

use crate::workcell::NameFault;

/// Returns the place of an unknown name in the program `text`. `path` leads to the target or the
/// tool that requires it. The name may be in the motion, in a named frame, in a base, or be the
/// program's default; without any of them in the text, such as for an included file, the place is
/// that of `path`.
pub(crate) fn name_place(text: &str, path: &[JsonStep<'_>], fault: &NameFault) -> JsonPlace {
    use JsonStep::Key;
    let (name, key) = match fault {
        NameFault::Unknown { name, kind: "tool", .. } => (name, "tool"),
        NameFault::Unknown { name, .. } | NameFault::Cycle { name } => (name, "base"),
    };
    let document = serde_json::from_str::<Value>(text).unwrap_or_default();
    // A motion of a repeat block is several lists deep.
    let is_entry = |steps: &&[JsonStep<'_>]| matches!(steps, [Key("motions"), JsonStep::Index(_)]);
    let entry = 2 * path.chunks_exact(2).take_while(is_entry).count();
    let motion = &path[..entry.max(path.len().saturating_sub(1).min(2))];
    let mut candidates = vec![path.to_vec()];
    candidates.extend([path, motion].map(|owner| [owner, &[Key(key)]].concat()));
    if let Some(frame) = value_at(&document, path).and_then(Value::as_str) {
        candidates.push(vec![Key("frames"), Key(frame), Key(key)]);
    }
    candidates.push(vec![Key(key)]);
    let text_at = |path: &[JsonStep<'_>]| value_at(&document, path).and_then(Value::as_str);
    // A base may be given in another base: the names are followed from the first one.
    let mut chain: Vec<&str> =
        candidates[1..].iter().find_map(|it| text_at(it)).into_iter().collect();
    let mut in_bases = Vec::new();
    while key == "base"
        && let Some(base) = chain.last().copied()
        && let place = vec![Key("bases"), Key(base), Key(key)]
        && let Some(next) = text_at(&place)
        && !chain.contains(&next)
    {
        in_bases.push(place);
        chain.push(next);
    }
    candidates.extend(in_bases);
    let is_name = |path: &&Vec<JsonStep<'_>>| text_at(path) == Some(name);
    locate(text, candidates.iter().find(is_name).map_or(path, Vec::as_slice))
}

fn value_at<'a>(document: &'a Value, path: &[JsonStep<'_>]) -> Option<&'a Value> {
    path.iter().try_fold(document, |value, step| match step {
        JsonStep::Key(key) => value.get(key),
        JsonStep::Index(index) => value.get(index),
    })
}
