//! JSON form of programs. The types here are read, written and described by the JSON Schema.

mod all_errors;
mod block_size;
mod by_name;
mod cartesian;
mod entries;
mod error;
mod exact;
mod frames;
mod include;
mod io;
mod limits;
mod motion_list;
mod motions;
mod notes;
mod ptp;
mod repeat;
mod shapes;
mod spline;
mod target;
mod tasks;
mod wait;
mod workcell;

use std::collections::BTreeMap;

use iiwa_json::{JsonObject, JsonStep, locate, object, object_or_null, read_version, without_mark};
use iiwa_kin::Joints;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use crate::{
    program::{Program, Start},
    source::Sources,
    task::MAX_TASKS,
    workcell::{MAX_FLANGE_M, Workcell},
};
use by_name::{by_name, word_or_null};
use entries::{EntryWire, checked, entries_out};
use error::VERSION;
use exact::{exact_length_mm, exact_percent};
use frames::{BaseWire, TargetRefWire, TargetWire, ToolWire};
use include::{included, no_files};
use ptp::{joints_of, seven};
use tasks::TaskWire;
use workcell::{ModeWire, MountWire, WorkcellOut, mode_of, mount_of, named};

pub use all_errors::MAX_ERRORS;
pub use error::ProgramError;

impl Program {
    /// Reads a motion program (version 1) and checks everything that can be checked without a
    /// robot.
    ///
    /// ```
    /// use iiwa_program::Program;
    ///
    /// let text = r#"{
    ///     "version": 1,
    ///     "start": { "joints_deg": [0, 0, 0, 0, 0, 0] },
    ///     "motions": []
    /// }"#;
    /// let error = Program::from_json(text).unwrap_err();
    /// assert_eq!((error.place().line, error.place().column), (3, 30));
    /// ```
    ///
    /// # Errors
    ///
    /// If the text is not a program, or requires something that no robot can do; the error gives
    /// the place in the text.
    pub fn from_json(text: &str) -> Result<Self, ProgramError> {
        Self::from_json_with(text, no_files)
    }

    /// Reads a motion program that may include a file of tools, bases and frames. `read` returns
    /// the text of the file named by the key `include`, or the reason why the file cannot be read.
    /// Names of the program take precedence over names of the file.
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
    /// As [`from_json`](Self::from_json); [`ProgramError::Included`] for an error within the file.
    pub fn from_json_with(
        text: &str,
        read: impl FnOnce(&str) -> Result<String, String>,
    ) -> Result<Self, ProgramError> {
        let text = without_mark(text);
        let wire = read_version(text, VERSION, |wire: &ProgramWire<'_>| wire.version)
            .map_err(|error| ProgramError::unread(text, error))?;
        let start = wire.start.start().map_err(|message| ProgramError::Json {
            message: format!("the start pose: {message}"),
            motion: None,
            sources: Sources::default(),
            place: locate(text, &[JsonStep::Key("start")]),
        })?;
        let program_cell = Workcell {
            tool: wire.tool,
            base: wire.base,
            mode: mode_of(wire.mode),
            mount: mount_of(wire.mount),
            flange_m: wire.flange_mm.map(|mm| mm / 1e3),
            torque_limit_rel: wire.limit_torque_percent.map(|percent| percent / 100.0),
            speed_override: wire.override_percent.map(|percent| percent / 100.0),
            ..named(text, wire.tools, wire.bases, wire.frames)?
        };
        let workcell = match wire.include {
            Some(name) => included(text, &name, read)?.updated_with(program_cell),
            None => program_cell,
        };
        let mut sources = Sources::default();
        sources.set_tasks(wire.tasks.into_iter().map(|JsonObject(task)| task.into()).collect());
        let program = Program { robot: wire.robot, start, motions: Vec::new(), workcell, sources };
        checked(text, program, &wire.motions)
    }

    /// Writes the program as JSON (version 1), with joints in rad, so that it reads back exactly. A
    /// repeat block whose rounds are no longer the same is written out.
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
            flange_mm: self.workcell.flange_m.map(exact_length_mm),
            start: StartWire::from(&self.start),
            workcell: WorkcellOut::from(&self.workcell),
            limit_torque_percent: self.workcell.torque_limit_rel.map(exact_percent),
            override_percent: self.workcell.speed_override.map(exact_percent),
            tasks: self.sources.tasks().iter().map(TaskWire::from).collect(),
            motions: entries_out(&self.motions, &self.sources),
        };
        // Serialisation can only fail for a map whose keys are not strings.
        serde_json::to_string_pretty(&wire).unwrap_or_default()
    }

    /// JSON Schema of a motion program (draft 2020-12).
    #[must_use]
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(ProgramWire<'_>).to_value()
    }
}

/// A motion program for the KUKA LBR iiwa.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "iiwasim motion program", rename = "Program")]
struct ProgramWire<'a> {
    /// URL or path of the JSON Schema of this format, for editors; otherwise unused.
    #[serde(default, rename = "$schema")]
    #[expect(dead_code, reason = "it is for editors")]
    schema: Option<String>,
    /// Version of this format.
    #[schemars(extend("const" = 1))]
    version: u64,
    /// A built-in model (`lbr_iiwa_7_r800`, `lbr_iiwa_14_r820`) or a robot profile file.
    #[serde(default)]
    robot: Option<String>,
    /// Flange length, from the wrist to the flange face, in mm: 152 with a media flange "Touch",
    /// 126 with others; the model's by default.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e3 * MAX_FLANGE_M))]
    flange_mm: Option<f64>,
    /// A file with further `tools`, `bases` and `frames`: `*.json` in the program's folder or in a
    /// folder below it.
    #[serde(default)]
    include: Option<String>,
    /// Start pose before the first motion.
    #[serde(deserialize_with = "object")]
    start: StartWire,
    /// Tools by name.
    #[serde(default, deserialize_with = "by_name")]
    tools: BTreeMap<String, ToolWire>,
    /// Reference frames for other frames, by name.
    #[serde(default, deserialize_with = "by_name")]
    bases: BTreeMap<String, BaseWire>,
    /// Target frames, by name.
    #[serde(default, deserialize_with = "by_name")]
    frames: BTreeMap<String, TargetWire>,
    /// Tool in use, `TOOL` or `TOOL/TIP`; `flange` for the bare flange.
    #[serde(default)]
    tool: Option<String>,
    /// Base in use; `robot` for the robot base.
    #[serde(default)]
    base: Option<String>,
    /// Operating mode of the controller.
    #[serde(default, deserialize_with = "word_or_null")]
    mode: Option<ModeWire>,
    /// Mounting of the robot.
    #[serde(default, deserialize_with = "object_or_null")]
    mount: Option<MountWire>,
    /// Torque limit of the joints as a percentage of the robot's torque limits; reduces the speed
    /// where necessary.
    #[serde(default)]
    #[schemars(range(min = 1.0, max = 1000.0))]
    limit_torque_percent: Option<f64>,
    /// Override of the controller: slows down motions, but neither the standstill after stops nor
    /// waits.
    #[serde(default)]
    #[schemars(range(min = 0.1, max = 100.0))]
    override_percent: Option<f64>,
    /// Groups of motions that may be executed in another order.
    #[serde(default)]
    #[schemars(with = "Vec<TaskWire>", length(max = MAX_TASKS))]
    tasks: Vec<JsonObject<TaskWire>>,
    /// Motions and repeat blocks in order.
    #[serde(borrow)]
    #[schemars(with = "Vec<EntryWire>", length(min = 1))]
    motions: Vec<&'a RawValue>,
}

#[derive(Serialize)]
struct ProgramOut<'a> {
    version: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    robot: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    flange_mm: Option<f64>,
    start: StartWire,
    #[serde(flatten)]
    workcell: WorkcellOut<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit_torque_percent: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    override_percent: Option<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    tasks: Vec<TaskWire>,
    motions: Vec<EntryWire>,
}

/// Start pose: `joints_deg`, `joints_rad` or a `frame`.
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
    /// TCP frame, with `e1_deg` and `status`.
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
