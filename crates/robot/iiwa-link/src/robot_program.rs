//! The messages between iiwaDrive and the robot program on the cabinet, in JSON (Larsen 2019, section
//! 3.1.1).
//!
//! Instructions go to the robot program, and state changes come from it on another socket; each is
//! acknowledged. iiwaDrive gives each run a number, so that its end is identified even after lost messages
//! and restarts.

use std::time::Duration;

use iiwa_json::Object;
use iiwa_program::MotionList;
use serde::{
    Deserialize, Serialize,
    de::{DeserializeOwned, IgnoredAny},
};

use crate::message::{
    Conditions, DriveState, Hello, IoValue, Refusal, Sensors, Signal, bad_json, shortened, to_json,
};

/// The version of the protocol between a drive and a robot program. It changes when one of them could not carry out
/// what the other one of the version before asks for.
pub const PROTOCOL: u32 = 1;

/// The number of a run.
pub type RunId = u64;

/// An instruction to the robot program.
#[expect(clippy::large_enum_variant, reason = "an instruction is moved a few times in a run")]
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Instruction {
    /// Plan motions from the position of the arm. They wait for [`Begin`](Self::Begin).
    RunMotions {
        /// Their run.
        run: RunId,
        /// The motions, and the tools, bases and frames that they use.
        #[serde(flatten)]
        motions: MotionList,
    },
    /// Begin the planned motions.
    Begin {
        /// Their run.
        run: RunId,
    },
    /// Enable commanding over FRI.
    RunTrajectory {
        /// The run of the trajectory.
        run: RunId,
    },
    /// End commanding over FRI.
    EndTrajectory {
        /// The run of the trajectory.
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
        /// Its name.
        name: String,
    },
    /// Set an output.
    SetIo {
        /// Its name.
        name: String,
        /// Its new value.
        value: IoValue,
    },
}

impl Instruction {
    /// The instruction as JSON, with its number.
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

    /// Parses an instruction and its number, `None` without one.
    ///
    /// # Errors
    ///
    /// A [`Refusal`] with what is wrong in the JSON.
    pub fn from_json(bytes: &[u8]) -> (Option<u64>, Result<Self, Refusal>) {
        #[derive(Deserialize)]
        struct InstructionHead {
            seq: u64,
            r#type: String,
        }
        let Ok(text) = std::str::from_utf8(bytes) else {
            return (None, Err(Refusal::bad("the instruction is not text in UTF-8")));
        };
        match serde_json::from_str::<Object<InstructionHead>>(text) {
            Ok(Object(head)) => (Some(head.seq), Self::of_type(&head.r#type, text)),
            Err(error) => (None, Err(bad_json(text, &error))),
        }
    }

    fn of_type(name: &str, text: &str) -> Result<Self, Refusal> {
        #[derive(Deserialize)]
        struct RunKey {
            run: RunId,
        }
        /// Of motions, a key that is passed over may be a limit that they would not keep.
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

/// The acknowledgement of an instruction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Acknowledgement {
    /// The number of the instruction; `None` if it could not be parsed.
    pub seq: Option<u64>,
    /// Why it was not carried out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<Refusal>,
    /// The sensors, if they were read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensors: Option<Sensors>,
    /// All inputs and outputs, if they were read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub io: Option<Vec<Signal>>,
    /// The value of the input or output that was read or set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<IoValue>,
}

/// The state of the robot program: sent when it changes, repeated until it is acknowledged, and twice a second
/// in any case.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StateChange {
    /// A number that differs with each start of the robot program.
    pub boot: u64,
    /// The state.
    pub state: DriveState,
    /// The current run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run: Option<RunId>,
    /// The outcome of the last run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outcome: Option<Outcome>,
    /// Whether the robot is simulated, so that no person is near it. A robot program on a real cabinet never sets it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
    /// The versions of the robot program. Without them, it has version 1 of the protocol.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hello: Option<Hello>,
    /// The conditions at the controller, as far as they are known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<Conditions>,
}

/// The outcome of a run. Times are of the controller's clock, as are the time stamps of FRI.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// The run.
    pub run: RunId,
    /// Its start, in s; `None` if it did not start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_s: Option<f64>,
    /// Its end, in s; `None` if the robot program does not know FRI's clock. Then the drive takes start and end from
    /// the commanded joint positions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_s: Option<f64>,
    /// Why it was aborted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<Refusal>,
}

/// The acknowledgement of a state change.
pub const RECEIVED: &str = r#"{"ok":true}"#;

/// How long planned motions may wait for [`Instruction::Begin`]. A robot program discards them afterwards, as
/// the drive or its client may be gone.
pub const BEGIN_WITHIN: Duration = Duration::from_secs(2);

/// Interval at which the robot program sends its state even if it does not change, in ms.
pub const STATE_EVERY_MS: u64 = 500;
