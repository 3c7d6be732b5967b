//! JSON form of motion lists.

use std::collections::BTreeMap;

use iiwa_json::{JsonObject, JsonStep, locate, object_or_null};
use serde::{Deserialize, Serialize, Serializer};
use serde_json::value::RawValue;

use super::{
    by_name::{by_name, word_or_null},
    entries::{EntryWire, checked, motions_out},
    error::{ProgramError, json_error},
    frames::{BaseWire, TargetWire, ToolWire},
    workcell::{ModeWire, MountWire, WorkcellOut, mode_of, mount_of, named},
};
use crate::{motion_list::MotionList, source::Sources, workcell::Workcell};

impl MotionList {
    /// Reads `motions` of a JSON object, with `tools`, `bases`, `frames`, `tool`, `base`, `mode`
    /// and `mount` if present, all written as in a program, and checks everything that can be
    /// checked without a robot. Other keys of the object are ignored.
    ///
    /// ```
    /// use iiwa_program::MotionList;
    ///
    /// let text = r#"{ "tools": { "gripper": { "tcp": { "z_mm": 120 } } }, "tool": "griper",
    ///                 "motions": [{ "type": "lin_rel", "offset": { "z_mm": -50 } }] }"#;
    /// let error = MotionList::from_json(text).unwrap_err();
    /// assert_eq!(error.message(), "unknown tool `griper`; did you mean `gripper`?");
    /// assert_eq!((error.place().line, error.place().column), (1, 63));
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Program::from_json`](crate::Program::from_json), and if the tool or the base in use is
    /// unknown.
    pub fn from_json(text: &str) -> Result<Self, ProgramError> {
        let fail = |error: serde_json::Error| json_error(text, text, None, &error);
        let JsonObject(MotionsWire { motions }) = serde_json::from_str(text).map_err(fail)?;
        let JsonObject(wire) =
            serde_json::from_str::<JsonObject<WorkcellWire>>(text).map_err(fail)?;
        let workcell = Workcell {
            tool: wire.tool,
            base: wire.base,
            mode: mode_of(wire.mode),
            mount: mount_of(wire.mount),
            ..named(text, wire.tools, wire.bases, wire.frames)?
        };
        let in_use =
            [("tool", workcell.tcp(None).map(drop)), ("base", workcell.base(None).map(drop))];
        let list = Self { motions: Vec::new(), workcell, sources: Sources::default() };
        let list = checked(text, list.starting_at([0.0; 7]), &motions).map(Self::from)?;
        for (key, checked_frame) in in_use {
            checked_frame.map_err(|fault| ProgramError::Json {
                message: fault.to_string(),
                motion: None,
                sources: Sources::default(),
                place: locate(text, &[JsonStep::Key(key)]),
            })?;
        }
        Ok(list)
    }
}

/// Writes the motions as in a program, joints in rad; empty keys are left out. Repeat blocks are
/// written out, round by round, so that any reader of motions understands the list.
impl Serialize for MotionList {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct MotionListOut<'a> {
            motions: Vec<EntryWire>,
            #[serde(flatten)]
            workcell: WorkcellOut<'a>,
        }
        let Self { motions, workcell, sources } = self;
        let motions = motions_out(motions, sources);
        MotionListOut { motions, workcell: workcell.into() }.serialize(serializer)
    }
}

#[derive(Deserialize)]
struct MotionsWire<'a> {
    #[serde(borrow)]
    motions: Vec<&'a RawValue>,
}

/// Keys that a motion list has in common with programs, which declare them with their schema.
#[derive(Deserialize)]
struct WorkcellWire {
    #[serde(default, deserialize_with = "by_name")]
    tools: BTreeMap<String, ToolWire>,
    #[serde(default, deserialize_with = "by_name")]
    bases: BTreeMap<String, BaseWire>,
    #[serde(default, deserialize_with = "by_name")]
    frames: BTreeMap<String, TargetWire>,
    #[serde(default)]
    tool: Option<String>,
    #[serde(default)]
    base: Option<String>,
    #[serde(default, deserialize_with = "word_or_null")]
    mode: Option<ModeWire>,
    #[serde(default, deserialize_with = "object_or_null")]
    mount: Option<MountWire>,
}
