//! The program's JSON form. The types here are the ones that are read, written and described by
//! the JSON Schema.

mod by_name;
mod cartesian;
mod error;
mod frames;
mod include;
mod limits;
mod ptp;
mod share;
mod spline;
mod target;

use std::collections::BTreeMap;

use iiwa_json::{Object, Step, excerpt, locate, object, read_version, tag};
use iiwa_kin::Joints;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::value::RawValue;

use crate::{
    cartesian_motion::{Course, SegmentCourse, SplineSegment},
    motion_index::MotionIndex,
    program::{Motion, Program, Start},
    workcell::{OperatingMode, Workcell},
};
use by_name::{by_name, word_or_null};
use cartesian::{CircWire, LinRelWire, LinWire};
use error::{VERSION, json_error};
use frames::{BaseWire, TargetRefWire, TargetWire, ToolWire};
use include::{included, no_files};
use ptp::{PtpWire, joints_of, seven};
use spline::{SplWire, SplineWire, WrongSegment};

pub use error::ProgramError;

impl Program {
    /// Reads a motion program (version 1) and checks all that can be checked without a robot.
    ///
    /// ```
    /// use iiwa_program::Program;
    ///
    /// let text = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0] }, "motions": [] }"#;
    /// let error = Program::from_json(text).unwrap_err();
    /// assert_eq!((error.place().line, error.place().column), (1, 42));
    /// ```
    ///
    /// # Errors
    ///
    /// If the text is not a program, or asks for something that no robot can do; the error says
    /// where in the text.
    pub fn from_json(text: &str) -> Result<Self, ProgramError> {
        Self::from_json_with(text, no_files)
    }

    /// Reads a motion program that may include a file of tools, bases and frames: `read` gives the text of the
    /// file that its key `include` names, or returns why it cannot. The program's own names win over those of
    /// the file.
    ///
    /// ```
    /// use iiwa_program::Program;
    ///
    /// let text = r#"{ "version": 1, "include": "cell.json", "tool": "gripper",
    ///                 "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    ///                 "motions": [{ "type": "lin_rel", "offset": { "z_mm": -50 } }] }"#;
    /// let cell = r#"{ "version": 1, "tools": { "gripper": { "tcp": { "z_mm": 120 } } } }"#;
    /// let program = Program::from_json_with(text, |name| match name {
    ///     "cell.json" => Ok(cell.to_owned()),
    ///     _ => Err("there is no such file".to_owned()),
    /// })?;
    /// assert_eq!(program.workcell.tools["gripper"].tcp.xyz_mm[2], 120.0);
    /// # Ok::<(), iiwa_program::ProgramError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`from_json`](Self::from_json); [`ProgramError::Included`] if something is wrong within the file.
    pub fn from_json_with(
        text: &str,
        read: impl FnOnce(&str) -> Result<String, String>,
    ) -> Result<Self, ProgramError> {
        let wire = read_version(text, VERSION, |wire: &ProgramWire<'_>| wire.version)
            .map_err(|error| ProgramError::unread(text, error))?;
        let at = |what: String, path: &[Step<'_>]| ProgramError::Json {
            what,
            motion: None,
            place: locate(text, path),
        };
        let start = wire
            .start
            .start()
            .map_err(|what| at(format!("the start pose: {what}"), &[Step::Key("start")]))?;
        let workcell = frames::workcell(wire.tools, wire.bases, wire.frames).map_err(
            |(list, name, what)| {
                at(format!("`{name}`: {what}"), &[Step::Key(list), Step::Key(&name)])
            },
        )?;
        let workcell = match wire.include {
            Some(name) => included(text, &name, read)?.updated_with(workcell),
            None => workcell,
        };
        let mode = wire.mode.map_or_else(OperatingMode::default, OperatingMode::from);
        let workcell = Workcell { tool: wire.tool, base: wire.base, mode, ..workcell };
        let program = Program { robot: wire.robot, start, motions: Vec::new(), workcell };
        checked(text, program, &wire.motions)
    }

    /// The program as JSON (version 1), joints in rad, so that it reads back as it is.
    ///
    /// ```
    /// use iiwa_program::Program;
    ///
    /// let program = Program::from_deg([0.0; 7]).ptp_deg([30.0; 7]).build();
    /// assert_eq!(Program::from_json(&program.to_json())?, program);
    /// # Ok::<(), iiwa_program::ProgramError>(())
    /// ```
    #[must_use]
    pub fn to_json(&self) -> String {
        let wire = ProgramOut {
            version: VERSION,
            robot: self.robot.as_deref(),
            start: StartWire::from(&self.start),
            tools: self
                .workcell
                .tools
                .iter()
                .map(|(name, tool)| (name.as_str(), tool.into()))
                .collect(),
            bases: self
                .workcell
                .bases
                .iter()
                .map(|(name, base)| (name.as_str(), base.into()))
                .collect(),
            frames: self
                .workcell
                .frames
                .iter()
                .map(|(name, target)| (name.as_str(), target.into()))
                .collect(),
            tool: self.workcell.tool.as_deref(),
            base: self.workcell.base.as_deref(),
            mode: ModeWire::of(self.workcell.mode),
            motions: self.motions.iter().map(MotionWire::from).collect(),
        };
        // Only a map with keys that are no strings could fail.
        serde_json::to_string_pretty(&wire).unwrap_or_default()
    }

    /// The JSON Schema of a motion program (draft 2020-12).
    #[must_use]
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(ProgramWire<'_>).to_value()
    }
}

impl Motion {
    /// Reads the list `motions` of a JSON object, written as in a program, and checks all that can be
    /// checked without a robot. Other keys of the object are passed over.
    ///
    /// # Errors
    ///
    /// As [`Program::from_json`].
    pub fn list_from_json(text: &str) -> Result<Vec<Self>, ProgramError> {
        let Object(list) = serde_json::from_str::<Object<MotionsOnly<'_>>>(text)
            .map_err(|error| json_error(text, text, None, &error))?;
        let program = Program::from_rad([0.0; 7]).build();
        checked(text, program, &list.motions).map(|program| program.motions)
    }
}

/// As in a program, joints in rad.
impl Serialize for Motion {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        MotionWire::from(self).serialize(serializer)
    }
}

/// The program with these motions, checked as far as it can be without a robot.
fn checked(text: &str, program: Program, motions: &[&RawValue]) -> Result<Program, ProgramError> {
    let motions = motions.iter().enumerate().map(|(index, raw)| motion(text, index, raw.get()));
    let program = Program { motions: motions.collect::<Result<_, _>>()?, ..program };
    match program.check_numbers() {
        Ok(()) => Ok(program),
        Err(fault) => Err(ProgramError::Fault { place: fault.place_in(text), fault }),
    }
}

fn motion(text: &str, index: usize, raw: &str) -> Result<Motion, ProgramError> {
    let motion = Some(MotionIndex::new(index));
    let fail = |error: serde_json::Error| json_error(text, raw, motion, &error);
    let wrong = |what: String, key: Option<&str>| {
        let path = [Step::Key("motions"), Step::Index(index)].into_iter().chain(key.map(Step::Key));
        let place = locate(text, &path.collect::<Vec<_>>());
        ProgramError::Json { what, motion, place }
    };
    match tag(raw).map_err(fail)?.as_deref() {
        Some("ptp") => {
            let Object(wire) = serde_json::from_str::<Object<PtpWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|what| wrong(what, None))
        }
        Some("lin") => {
            let Object(wire) = serde_json::from_str::<Object<LinWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|(key, what)| wrong(what, Some(key)))
        }
        Some("lin_rel") => {
            let Object(wire) = serde_json::from_str::<Object<LinRelWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|(key, what)| wrong(what, Some(key)))
        }
        Some("circ") => {
            let Object(wire) = serde_json::from_str::<Object<CircWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|(key, what)| wrong(what, Some(key)))
        }
        Some("spl") => {
            let Object(wire) = serde_json::from_str::<Object<SplWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|(key, what)| wrong(what, Some(key)))
        }
        Some("spline") => {
            let Object(wire) = serde_json::from_str::<Object<SplineWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|WrongSegment { index: segment, key, what }| {
                let path = [Step::Key("motions"), Step::Index(index), Step::Key("segments")];
                let path = [&path[..], &[Step::Index(segment), Step::Key(key)]].concat();
                let what = format!("segment {}: {what}", segment + 1);
                ProgramError::Json { what, motion, place: locate(text, &path) }
            })
        }
        Some("wait") => {
            let Object(wire) = serde_json::from_str::<Object<WaitWire>>(raw).map_err(fail)?;
            Ok(Motion::Wait { seconds: wire.seconds })
        }
        Some(other) => {
            let what = format!("unknown type `{}`; {KNOWN_TYPES} are known", excerpt(other));
            Err(wrong(what, Some("type")))
        }
        None => Err(wrong(format!("it has no `type`; {KNOWN_TYPES} are known"), None)),
    }
}

/// The types of motions.
const KNOWN_TYPES: &str = "`ptp`, `lin`, `lin_rel`, `circ`, `spline`, `spl` and `wait`";

#[derive(Deserialize)]
struct MotionsOnly<'a> {
    #[serde(borrow)]
    motions: Vec<&'a RawValue>,
}

/// A motion program for the KUKA LBR iiwa.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "iiwasim motion program", rename = "Program")]
struct ProgramWire<'a> {
    /// Version of this format.
    #[schemars(extend("const" = 1))]
    version: u64,
    /// A built-in model (`lbr_iiwa_7_r800`, `lbr_iiwa_14_r820`) or a robot profile file.
    #[serde(default)]
    robot: Option<String>,
    /// A file with more `tools`, `bases` and `frames`, `*.json` beside the program or in a folder below it.
    #[serde(default)]
    include: Option<String>,
    /// Where the arm stands before the first motion.
    #[serde(deserialize_with = "object")]
    start: StartWire,
    /// Tools by name.
    #[serde(default, deserialize_with = "by_name")]
    tools: BTreeMap<String, ToolWire>,
    /// Frames that others are given in, by name.
    #[serde(default, deserialize_with = "by_name")]
    bases: BTreeMap<String, BaseWire>,
    /// Frames to go to, by name.
    #[serde(default, deserialize_with = "by_name")]
    frames: BTreeMap<String, TargetWire>,
    /// The tool in use, `TOOL` or `TOOL/TIP`; `flange` is none.
    #[serde(default)]
    tool: Option<String>,
    /// The base in use; `robot` is the robot's foot.
    #[serde(default)]
    base: Option<String>,
    /// The operating mode of the controller.
    #[serde(default, deserialize_with = "word_or_null")]
    mode: Option<ModeWire>,
    /// What it does, in order.
    #[serde(borrow)]
    #[schemars(with = "Vec<MotionWire>", length(min = 1))]
    motions: Vec<&'a RawValue>,
}

#[derive(Serialize)]
struct ProgramOut<'a> {
    version: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    robot: Option<&'a str>,
    start: StartWire,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    tools: BTreeMap<&'a str, ToolWire>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    bases: BTreeMap<&'a str, BaseWire>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    frames: BTreeMap<&'a str, TargetWire>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tool: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    base: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mode: Option<ModeWire>,
    motions: Vec<MotionWire>,
}

/// An operating mode of the controller.
#[derive(Clone, Copy, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "OperatingMode")]
enum ModeWire {
    /// For tests: TCP and flange go at 250 mm/s at most.
    T1,
}

impl ModeWire {
    fn of(mode: OperatingMode) -> Option<Self> {
        match mode {
            OperatingMode::Automatic => None,
            OperatingMode::T1 => Some(Self::T1),
        }
    }
}

impl From<ModeWire> for OperatingMode {
    fn from(ModeWire::T1: ModeWire) -> Self {
        Self::T1
    }
}

/// The start pose: `joints_deg`, `joints_rad` or a `frame`.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    rename = "Start",
    extend("oneOf" = [
        {"required": ["joints_deg"]}, {"required": ["joints_rad"]}, {"required": ["frame"]}
    ])
)]
struct StartWire {
    /// Joints A1 to A7, in rad.
    #[serde(default, deserialize_with = "seven", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 7]")]
    joints_rad: Option<Joints>,
    /// Joints A1 to A7, in degrees.
    #[serde(default, deserialize_with = "seven", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 7]")]
    joints_deg: Option<Joints>,
    /// A frame for the TCP, with `e1_deg` and `status`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    frame: Option<TargetRefWire>,
}

impl StartWire {
    fn start(self) -> Result<Start, String> {
        match self.frame {
            None => Ok(Start::Joints(joints_of(self.joints_rad, self.joints_deg)?)),
            Some(_) if self.joints_rad.is_some() || self.joints_deg.is_some() => {
                Err("give either the joints or a `frame`, not both".to_owned())
            }
            Some(frame) => Ok(Start::Frame(frame.target()?)),
        }
    }
}

impl From<&Start> for StartWire {
    fn from(start: &Start) -> Self {
        match start {
            Start::Joints(joints_rad) => {
                Self { joints_rad: Some(*joints_rad), joints_deg: None, frame: None }
            }
            Start::Frame(frame) => {
                Self { joints_rad: None, joints_deg: None, frame: Some(frame.into()) }
            }
        }
    }
}

/// One entry of the list of motions.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "Motion")]
enum MotionWire {
    Ptp(PtpWire),
    Lin(LinWire),
    LinRel(LinRelWire),
    Circ(CircWire),
    Spline(SplineWire),
    Spl(SplWire),
    Wait(WaitWire),
}

#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(inline)]
enum WaitTag {
    #[serde(rename = "wait")]
    Wait,
}

/// The arm stands still.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Wait")]
struct WaitWire {
    r#type: WaitTag,
    /// For how long, in s: at most a day.
    #[schemars(range(min = 0, max = 86_400))]
    seconds: f64,
}

impl From<&Motion> for MotionWire {
    fn from(motion: &Motion) -> Self {
        match motion {
            Motion::Wait { seconds } => {
                Self::Wait(WaitWire { r#type: WaitTag::Wait, seconds: *seconds })
            }
            Motion::Ptp(ptp) => {
                let shares = [ptp.velocity_rel, ptp.acceleration_rel, ptp.jerk_rel];
                Self::Ptp(PtpWire::to_joints(&ptp.target_rad, shares, ptp.blend))
            }
            Motion::Cartesian(own) => match &own.course {
                Course::Ptp { to } => Self::Ptp(PtpWire::to_frame(own, to)),
                Course::Lin { to } => Self::Lin(LinWire::new(own, to)),
                Course::LinRel { offset, e1_rad, within } => {
                    Self::LinRel(LinRelWire::new(own, offset, *e1_rad, within.as_ref()))
                }
                Course::Circ(circ) => Self::Circ(CircWire::new(own, circ)),
                Course::Spline(segments) => match segments.as_slice() {
                    [SplineSegment { course: SegmentCourse::Spl { to }, .. }]
                        if own.is_single_spl() =>
                    {
                        Self::Spl(SplWire::new(own, to))
                    }
                    segments => Self::Spline(SplineWire::new(own, segments)),
                },
            },
        }
    }
}
