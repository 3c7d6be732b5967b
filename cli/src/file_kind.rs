//! Detection of files passed to the wrong option.

use iiwa_kin::Robot;
use iiwa_program::Workcell;
use serde_json::{Map, Value};

/// Kind of JSON file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JsonKind {
    /// A motion program.
    Program,
    /// A robot profile.
    Profile,
    /// A scene.
    Scene,
    /// Tools, bases and frames for programs to include.
    Frames,
}

impl JsonKind {
    /// Returns the kind of a text; `None` if unknown.
    pub(crate) fn of(text: &str) -> Option<Self> {
        let object: Map<String, Value> = serde_json::from_str(text).ok()?;
        let has = |key| object.contains_key(key);
        if ["start", "motions"].into_iter().any(has) {
            Some(Self::Program)
        } else if object.keys().all(|key| key == "version" || key == "$schema") {
            None
        } else if has("obstacles") || object.get("tool").is_some_and(Value::is_array) {
            Some(Self::Scene)
        } else if Robot::from_profile(text).is_ok() {
            Some(Self::Profile)
        } else if Workcell::from_json(text).is_ok() {
            Some(Self::Frames)
        } else {
            None
        }
    }

    /// Returns the hint for a file of this kind given in place of a `wanted` one.
    fn hint(self, wanted: &str) -> String {
        let (actual, place) = match self {
            Self::Program => ("motion program", ""),
            Self::Profile => ("robot profile", ": it belongs to --robot"),
            Self::Scene => ("scene", ": it belongs to --scene"),
            Self::Frames => {
                ("file of tools, bases and frames", ": programs name it under `include`")
            }
        };
        format!("is a {actual}, not a {wanted}{place}")
    }
}

/// Returns the message about a file that is of another kind than expected, if its kind is known.
pub(crate) fn other_kind(name: &str, text: &str, actual: JsonKind, wanted: &str) -> Option<String> {
    let kind = JsonKind::of(text).filter(|kind| *kind != actual)?;
    Some(format!("{name} {}", kind.hint(wanted)))
}

/// Returns a hint about the format of binary data, if known.
pub(crate) fn binary_hint(bytes: &[u8]) -> &'static str {
    if bytes.starts_with(b"\x89MCAP") {
        ", but an MCAP file: `iiwasim report`, `compare` and `identify` read these"
    } else {
        ""
    }
}
