//! JSON form of motion lists.

use iiwa_json::{JsonObject, JsonStep, locate};
use serde::{Deserialize, Serialize, Serializer};
use serde_json::value::RawValue;

use super::{
    error::{ProgramError, json_error},
    motions::{MotionWire, checked, motions_out},
    workcell::{WorkcellOut, WorkcellWire},
};
use crate::{motion_list::MotionList, source::Sources};

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
        let workcell = wire.workcell(text)?;
        let in_use =
            [("tool", workcell.tcp(None).map(drop)), ("base", workcell.base(None).map(drop))];
        let list = Self { motions: Vec::new(), workcell, sources: Sources::default() };
        let list = checked(text, list.starting_at([0.0; 7]), &motions).map(Self::from)?;
        for (key, checked_frame) in in_use {
            checked_frame.map_err(|fault| ProgramError::Json {
                message: fault.to_string(),
                motion: None,
                made_from: None,
                place: locate(text, &[JsonStep::Key(key)]),
            })?;
        }
        Ok(list)
    }
}

/// Writes the motions as in a program, joints in rad; empty keys are left out.
impl Serialize for MotionList {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct MotionListOut<'a> {
            motions: Vec<MotionWire>,
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
