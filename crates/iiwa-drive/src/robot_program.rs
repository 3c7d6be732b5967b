//! The messages between iiwaDrive and the robot program on the cabinet, in JSON (Larsen 2019, section
//! 3.1.1).
//!
//! Instructions go to the robot program, state changes come from it, on a socket of their own; each is
//! acknowledged. A run is known by a number that iiwaDrive gives it, so that neither side takes the end
//! of one run for the end of another, whatever got lost or was started again.

use std::time::Duration;

use iiwa_json::Object;
use iiwa_link::message::{DriveState, IoValue, Refusal, Sensors, bad_json, shortened, to_json};
use iiwa_path::Motion;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// The number of a run.
pub(crate) type RunId = u64;

/// What iiwaDrive tells the robot program to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Instruction {
    /// Plan motions from where the arm is. They wait for [`Begin`](Self::Begin).
    RunMotions { run: RunId, motions: Vec<Motion> },
    /// Begin the motions that were planned last.
    Begin { run: RunId },
    /// Let a trajectory be commanded over FRI.
    RunTrajectory { run: RunId },
    /// The trajectory is over.
    EndTrajectory { run: RunId },
    /// Stop what is running, and forget what was planned.
    Stop,
    /// Read the sensors.
    ReadSensors,
    /// Read an input or output.
    GetIo { name: String },
    /// Set an output.
    SetIo { name: String, value: IoValue },
}

impl Instruction {
    /// The instruction as the `seq`-th message.
    pub(crate) fn to_json(&self, seq: u64) -> String {
        #[derive(Serialize)]
        struct Out<'a> {
            seq: u64,
            #[serde(flatten)]
            instruction: &'a Instruction,
        }
        to_json(&Out { seq, instruction: self })
    }

    /// Reads an instruction, with its `seq`.
    pub(crate) fn from_json(bytes: &[u8]) -> (Option<u64>, Result<Self, Refusal>) {
        #[derive(Deserialize)]
        struct Head {
            seq: u64,
            r#type: String,
        }
        let Ok(text) = std::str::from_utf8(bytes) else {
            return (None, Err(Refusal::bad("the instruction is not text in UTF-8")));
        };
        match serde_json::from_str::<Object<Head>>(text) {
            Ok(Object(head)) => (Some(head.seq), Self::of_type(&head.r#type, text)),
            Err(error) => (None, Err(bad_json(text, &error))),
        }
    }

    fn of_type(name: &str, text: &str) -> Result<Self, Refusal> {
        #[derive(Deserialize)]
        struct Of {
            run: RunId,
        }
        #[derive(Deserialize)]
        struct Named {
            name: String,
        }
        #[derive(Deserialize)]
        struct Valued {
            name: String,
            value: IoValue,
        }
        fn read<T: DeserializeOwned>(text: &str) -> Result<T, Refusal> {
            serde_json::from_str(text).map_err(|error| bad_json(text, &error))
        }
        Ok(match name {
            "run_motions" => {
                let Of { run } = read(text)?;
                let motions = Motion::list_from_json(text)
                    .map_err(|error| Refusal::bad(error.to_string()))?;
                Self::RunMotions { run, motions }
            }
            "begin" => Self::Begin { run: read::<Of>(text)?.run },
            "run_trajectory" => Self::RunTrajectory { run: read::<Of>(text)?.run },
            "end_trajectory" => Self::EndTrajectory { run: read::<Of>(text)?.run },
            "stop" => Self::Stop,
            "read_sensors" => Self::ReadSensors,
            "get_io" => Self::GetIo { name: read::<Named>(text)?.name },
            "set_io" => {
                let Valued { name, value } = read(text)?;
                Self::SetIo { name, value }
            }
            other => {
                return Err(Refusal::bad(format!(
                    "the robot program does not know the instruction `{}`",
                    shortened(other)
                )));
            }
        })
    }
}

/// The robot program's answer to an instruction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Acknowledgement {
    /// Of the instruction; none if it could not be read.
    pub(crate) seq: Option<u64>,
    /// Why it is not carried out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<Refusal>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) sensors: Option<Sensors>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) value: Option<IoValue>,
}

/// What the robot program says of itself: when its state changes, again until that is acknowledged, and
/// twice a second in any case.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct StateChange {
    /// Another number each time the robot program starts.
    pub(crate) boot: u64,
    /// What it does.
    pub(crate) state: DriveState,
    /// The run that it is busy with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) run: Option<RunId>,
    /// How the run before has ended.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) outcome: Option<Outcome>,
}

/// How a run has ended. Times are those of the controller's clock, as in FRI's time stamps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Outcome {
    /// Which one.
    pub(crate) run: RunId,
    /// When it started, in s; none if it did not come so far.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) start_s: Option<f64>,
    /// When it ended, in s.
    pub(crate) end_s: f64,
    /// Why it ended early.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<Refusal>,
}

/// What is sent back for a state change.
pub(crate) const RECEIVED: &str = r#"{"ok":true}"#;

/// How long motions that were planned may wait until they are begun. A robot program forgets them then:
/// whoever wanted them has gone, or does not want them any more.
pub(crate) const BEGIN_WITHIN: Duration = Duration::from_secs(2);

/// How often the robot program says its state, also when nothing changes, in ms.
pub(crate) const STATE_EVERY_MS: u64 = 500;
