//! What a file is that is not what it was given as.

use iiwa_kin::Robot;
use iiwa_program::Workcell;
use serde_json::{Map, Value};

/// JSON files that are not programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JsonKind {
    /// A robot profile.
    Profile,
    /// A scene.
    Scene,
    /// Tools, bases and frames for programs to include.
    Frames,
}

impl JsonKind {
    /// The kind of a text that is no program; none if it may be one, or is of no kind that is known.
    pub(crate) fn of(text: &str) -> Option<Self> {
        let object: Map<String, Value> = serde_json::from_str(text).ok()?;
        let has = |key| object.contains_key(key);
        if is_program_object(&object)
            || object.keys().all(|key| key == "version" || key == "$schema")
        {
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

    /// A hint for a user who gave the file as a program.
    pub(crate) fn hint(self) -> &'static str {
        match self {
            Self::Profile => "is a robot profile, not a program: it belongs to --robot",
            Self::Scene => "is a scene, not a program: it belongs to --scene",
            Self::Frames => {
                "is a file of tools, bases and frames, not a program: programs name it under `include`"
            }
        }
    }
}

/// Whether a text that cannot be read was meant to be a program.
pub(crate) fn is_program(text: &str) -> bool {
    serde_json::from_str(text).is_ok_and(|object| is_program_object(&object))
}

fn is_program_object(object: &Map<String, Value>) -> bool {
    ["start", "motions"].iter().any(|key| object.contains_key(*key))
}

/// What bytes are that are no text, if that can be told.
pub(crate) fn binary_hint(bytes: &[u8]) -> &'static str {
    if bytes.starts_with(b"\x89MCAP") {
        ", but an MCAP file: `iiwasim report`, `compare` and `identify` read these"
    } else {
        ""
    }
}
