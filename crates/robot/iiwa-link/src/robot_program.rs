//! JSON messages between iiwaDrive and the robot program on the cabinet (Larsen 2019, section
//! 3.1.1).
//!
//! The drive sends instructions to the robot program, which sends state changes over another
//! socket; each message is acknowledged. iiwaDrive numbers the runs, so that the end of a run is
//! identified even after lost messages and restarts.

use std::time::Duration;

use iiwa_json::JsonObject;
use iiwa_program::MotionList;
use serde::{
    Deserialize, Serialize,
    de::{DeserializeOwned, IgnoredAny},
};

use crate::message::{
    Conditions, DriveState, Hello, IoValue, Refusal, Sensors, Signal, bad_json, shortened, to_json,
};

/// Version of the protocol between drive and robot program. It changes when either side requests
/// something that the other side, of the previous version, cannot carry out.
pub const PROTOCOL: u32 = 1;

/// Number of a run.
pub type RunId = u64;

/// An instruction to the robot program.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Instruction {
    /// Plan motions from the current position. They wait for [`Begin`](Self::Begin).
    RunMotions {
        /// Number of the run.
        run: RunId,
        /// The motions, with the tools, bases and frames that they use.
        #[serde(flatten)]
        motions: MotionList,
    },
    /// Begin the planned motions.
    Begin {
        /// Number of the run.
        run: RunId,
    },
    /// Enable commanding over FRI.
    RunTrajectory {
        /// Number of the trajectory's run.
        run: RunId,
    },
    /// End commanding over FRI.
    EndTrajectory {
        /// Number of the trajectory's run.
        run: RunId,
    },
    /// Stop the current run, and discard planned motions.
    Stop,
    /// Read the sensors.
    ReadSensors,
    /// Read all inputs and outputs.
    ListIo,
    /// Read an input or output.
    GetIo {
        /// Name of the signal.
        name: String,
    },
    /// Set an output.
    SetIo {
        /// Name of the output.
        name: String,
        /// New value.
        value: IoValue,
    },
}

impl Instruction {
    /// Returns the instruction as JSON, with its number.
    #[must_use]
    pub fn to_json(&self, seq: u64) -> String {
        #[derive(Serialize)]
        struct NumberedInstruction<'a> {
            seq: u64,
            #[serde(flatten)]
            instruction: &'a Instruction,
        }
        to_json(&NumberedInstruction { seq, instruction: self })
    }

    /// Parses an instruction and its number; `None` without a number.
    ///
    /// # Errors
    ///
    /// A [`Refusal`] with the JSON fault.
    pub fn from_json(bytes: &[u8]) -> (Option<u64>, Result<Self, Refusal>) {
        #[derive(Deserialize)]
        struct InstructionHead {
            seq: u64,
            r#type: String,
        }
        let Ok(text) = std::str::from_utf8(bytes) else {
            return (None, Err(Refusal::bad("the instruction is not text in UTF-8")));
        };
        match serde_json::from_str::<JsonObject<InstructionHead>>(text) {
            Ok(JsonObject(head)) => (Some(head.seq), Self::of_type(&head.r#type, text)),
            Err(error) => (None, Err(bad_json(text, &error))),
        }
    }

    fn of_type(name: &str, text: &str) -> Result<Self, Refusal> {
        #[derive(Deserialize)]
        struct RunKey {
            run: RunId,
        }
        /// Unknown keys of motions are refused: an ignored key may be a limit that the motions
        /// would exceed.
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct MotionsKeys {
            run: RunId,
            #[serde(rename = "seq")]
            _seq: IgnoredAny,
            #[serde(rename = "type")]
            _type: IgnoredAny,
            #[serde(rename = "motions")]
            _motions: IgnoredAny,
            #[serde(default, rename = "tools")]
            _tools: IgnoredAny,
            #[serde(default, rename = "bases")]
            _bases: IgnoredAny,
            #[serde(default, rename = "frames")]
            _frames: IgnoredAny,
            #[serde(default, rename = "tool")]
            _tool: IgnoredAny,
            #[serde(default, rename = "base")]
            _base: IgnoredAny,
            #[serde(default, rename = "mode")]
            _mode: IgnoredAny,
            #[serde(default, rename = "mount")]
            _mount: IgnoredAny,
        }
        #[derive(Deserialize)]
        struct NameKey {
            name: String,
        }
        #[derive(Deserialize)]
        struct ValueKeys {
            name: String,
            value: IoValue,
        }
        fn read<T: DeserializeOwned>(text: &str) -> Result<T, Refusal> {
            serde_json::from_str(text).map_err(|error| bad_json(text, &error))
        }
        Ok(match name {
            "run_motions" => {
                // Parsed first, because its errors contain the index of the motion.
                let motions =
                    MotionList::from_json(text).map_err(|error| Refusal::bad(error.to_string()))?;
                let MotionsKeys { run, .. } = read(text)?;
                Self::RunMotions { run, motions }
            }
            "begin" => Self::Begin { run: read::<RunKey>(text)?.run },
            "run_trajectory" => Self::RunTrajectory { run: read::<RunKey>(text)?.run },
            "end_trajectory" => Self::EndTrajectory { run: read::<RunKey>(text)?.run },
            "stop" => Self::Stop,
            "read_sensors" => Self::ReadSensors,
            "list_io" => Self::ListIo,
            "get_io" => Self::GetIo { name: read::<NameKey>(text)?.name },
            "set_io" => {
                let ValueKeys { name, value } = read(text)?;
                Self::SetIo { name, value }
            }
            other => {
                return Err(Refusal::bad(format!("unknown instruction `{}`", shortened(other))));
            }
        })
    }
}

/// Acknowledgement of an instruction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Acknowledgement {
    /// Number of the instruction; `None` if it could not be parsed.
    pub seq: Option<u64>,
    /// The reason why the instruction was not carried out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<Refusal>,
    /// Sensor readings, if requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensors: Option<Sensors>,
    /// All inputs and outputs, if requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub io: Option<Vec<Signal>>,
    /// Value of the input or output that was read or set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<IoValue>,
}

/// State of the robot program: sent on every change, repeated until acknowledged, and sent twice
/// per second in any case.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StateChange {
    /// Number that differs with each start of the robot program.
    pub boot: u64,
    /// The state.
    pub state: DriveState,
    /// The current run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run: Option<RunId>,
    /// The outcome of the last run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outcome: Option<Outcome>,
    /// `true` if the robot is simulated, so that no person is near it. A robot program on a real
    /// cabinet never sets this flag.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
    /// Versions of the robot program. Without them, its protocol version is 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hello: Option<Hello>,
    /// Controller conditions, as far as known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<Conditions>,
}

/// Outcome of a run. Times refer to the controller clock, like the FRI time stamps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Number of the run.
    pub run: RunId,
    /// Start, in s; `None` if the run did not start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_s: Option<f64>,
    /// End, in s; `None` if the robot program does not know the FRI clock. In this case the drive
    /// takes start and end from the commanded joint positions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_s: Option<f64>,
    /// The reason of an abort.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<Refusal>,
}

/// Acknowledgement of a state change.
pub const RECEIVED: &str = r#"{"ok":true}"#;

/// Time-out of planned motions that wait for [`Instruction::Begin`]. The robot program discards
/// them afterwards, because the drive or its client may be gone.
pub const BEGIN_WITHIN: Duration = Duration::from_secs(2);

/// Interval at which the robot program sends its state even without a change, in ms.
pub const STATE_EVERY_MS: u64 = 500;
