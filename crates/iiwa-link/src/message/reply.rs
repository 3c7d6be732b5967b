//! What the drive answers.

use std::fmt;

use iiwa_kin::Joints;
use serde::{Deserialize, Serialize};

use super::{Id, IoValue, Refusal, to_json};

/// What iiwaDrive and the robot are doing (Larsen 2019, section 3.1.1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DriveState {
    /// Nothing.
    #[default]
    Idle,
    /// Motions, planned by the controller.
    RunningMotion,
    /// A trajectory, commanded over FRI.
    RunningTrajectory,
}

impl DriveState {
    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::RunningMotion => "running_motion",
            Self::RunningTrajectory => "running_trajectory",
        }
    }
}

impl fmt::Display for DriveState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Measured joint positions over time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    /// Stamps, in s, as in the stream: time of the controller since iiwaDrive has first heard of it.
    pub t_s: Vec<f64>,
    /// Positions at these times, in rad.
    pub joints_rad: Vec<Joints>,
}

/// What a run measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// From the start to the end, in s; where the robot did not tell, there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycle_time_s: Option<f64>,
    /// When it started, in s, as stamps are; where the robot did not tell, there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_s: Option<f64>,
    /// What FRI brought from just before the start to the end.
    #[serde(default)]
    pub samples: Samples,
    /// Samples that were not kept, because the run was too long.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub samples_left_out: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde's way of calling")]
fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// The robot's sensors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensors {
    /// Temperatures of the joints, in degrees Celsius.
    pub joint_temperature_c: Joints,
    /// Torques from outside, in Nm.
    pub external_torque_nm: Joints,
}

/// How the connection to the controller is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FriStatus {
    /// State of the session, as `monitoring_ready`; `silent` when nothing comes in.
    pub session: String,
    /// The controller's verdict on the connection: `poor`, `fair`, `good` or `excellent`.
    pub quality: String,
    /// Messages of the controller that did not arrive.
    pub lost: u64,
    /// Messages that came after a younger one.
    pub late: u64,
}

impl FriStatus {
    /// The session of which nothing is heard.
    pub const SILENT: &str = "silent";
}

/// What the robot does now.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// What it is doing.
    pub state: DriveState,
    /// Measured joint positions, in rad; none before the controller has been heard of.
    pub joints_rad: Option<Joints>,
    /// When they were measured, in s.
    pub t_s: Option<f64>,
    /// The connection of FRI.
    pub fri: FriStatus,
    /// Whether the robot program is there.
    #[serde(default)]
    pub robot_program: Presence,
}

/// Whether somebody is heard of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Presence {
    /// For some time there was no word.
    #[default]
    Silent,
    /// There was, a moment ago.
    Connected,
}

/// What a reply brings.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Body {
    /// Of runs, also of those that were broken off, and of `last_run`.
    Run(Run),
    /// Of `state`.
    Status(Status),
    /// Of `read_sensors`.
    Sensors {
        /// What they say.
        sensors: Sensors,
    },
    /// Of `get_io` and `set_io`.
    Value {
        /// What it is now.
        value: IoValue,
    },
}

/// The answer to a request.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reply<'a> {
    /// The request's id.
    pub id: Option<&'a Id>,
    /// Why it was not, or not wholly, carried out.
    pub error: Option<&'a Refusal>,
    /// What was asked for.
    pub body: Option<&'a Body>,
}

impl Reply<'_> {
    /// The reply as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        #[derive(Serialize)]
        struct Out<'a> {
            ok: bool,
            #[serde(skip_serializing_if = "Option::is_none")]
            id: Option<&'a Id>,
            #[serde(skip_serializing_if = "Option::is_none")]
            error: Option<&'a Refusal>,
            #[serde(flatten)]
            body: Option<&'a Body>,
        }
        let Self { id, error, body } = *self;
        to_json(&Out { ok: error.is_none(), id, error, body })
    }
}
