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
        if has("start") || has("motions") || object.keys().all(|key| key == "version") {
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

    /// What it is, and what it is for, to somebody who gave it as a program.
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

/// What bytes are that are no text, if that can be told.
pub(crate) fn binary_hint(bytes: &[u8]) -> &'static str {
    if bytes.starts_with(b"\x89MCAP") {
        ", but an MCAP file: `iiwasim report`, `compare` and `identify` read these"
    } else {
        ""
    }
}
