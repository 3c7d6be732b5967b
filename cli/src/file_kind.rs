//! Kinds of JSON files, for files passed to the wrong option and for folders.

use iiwa_kin::Robot;
use iiwa_program::{Program, Workcell};
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
    /// A JSON Schema.
    Schema,
}

impl JsonKind {
    /// Returns the kind of a text by its keys, even if their values are invalid; `None` if unknown.
    pub(crate) fn of(text: &str) -> Option<Self> {
        let object: Map<String, Value> = serde_json::from_str(text).ok()?;
        let has = |key| object.contains_key(key);
        let url = object.get("$schema").and_then(Value::as_str);
        if url.is_some_and(|url| url.contains("://json-schema.org/")) {
            Some(Self::Schema)
        } else if ["start", "motions"].into_iter().any(has) {
            Some(Self::Program)
        } else if object.keys().all(|key| key == "version" || key == "$schema") {
            None
        } else if has("obstacles") || object.get("tool").is_some_and(Value::is_array) {
            Some(Self::Scene)
        } else if is_profile(&object) || Robot::from_profile(text).is_ok() {
            Some(Self::Profile)
        } else if is_workcell(&object) || Workcell::from_json(text).is_ok() {
            Some(Self::Frames)
        } else {
            None
        }
    }

    /// Returns the name of the kind.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Program => "motion program",
            Self::Profile => "robot profile",
            Self::Scene => "scene",
            Self::Frames => "file of tools, bases and frames",
            Self::Schema => "JSON Schema",
        }
    }

    /// Returns the fault of a text of this kind, with its place. Programs and scenes are not
    /// checked: they can name other files.
    pub(crate) fn fault(self, text: &str) -> Option<String> {
        match self {
            Self::Profile => Robot::from_profile(text).err().map(|error| error.to_string()),
            Self::Frames => Workcell::from_json(text).err().map(|error| error.to_string()),
            Self::Program | Self::Scene | Self::Schema => None,
        }
    }

    /// Returns the hint for a file of this kind given in place of a `wanted` one.
    fn hint(self, wanted: &str) -> String {
        let place = match self {
            Self::Program | Self::Schema => "",
            Self::Profile => ": it belongs to --robot",
            Self::Scene => ": it belongs to --scene",
            Self::Frames => ": programs name it under `include`",
        };
        format!("is a {}, not a {wanted}{place}", self.name())
    }
}

/// Returns true if an object has a key that only robot profiles have, or a built-in robot as its
/// `base`.
fn is_profile(object: &Map<String, Value>) -> bool {
    let keys = keys(&Robot::profile_schema());
    let others = keys_of_programs();
    let is_key = |key: &String| keys.contains(key) && !others.contains(key);
    let base = object.get("base").and_then(Value::as_str);
    object.keys().any(is_key) || base.is_some_and(|base| Robot::BUILT_IN.contains(&base))
}

/// Returns true if an object has tools, bases or frames, and no key that only programs have.
fn is_workcell(object: &Map<String, Value>) -> bool {
    let keys = keys(&Workcell::schema());
    let is_only_of_programs =
        |key: &String| keys_of_programs().contains(key) && !keys.contains(key);
    ["tools", "bases", "frames"].into_iter().any(|key| object.contains_key(key))
        && !object.keys().any(is_only_of_programs)
}

fn keys_of_programs() -> Vec<String> {
    keys(&Program::schema())
}

/// Returns the keys of the object that a JSON Schema describes.
fn keys(schema: &Value) -> Vec<String> {
    let properties = schema.get("properties").and_then(Value::as_object);
    properties.into_iter().flat_map(Map::keys).cloned().collect()
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
