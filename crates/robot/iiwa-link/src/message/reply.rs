//! Drive replies.

use std::{fmt, net::IpAddr};

use iiwa_kin::Joints;
use serde::{Deserialize, Serialize};

use crate::message::{
    conditions::{Conditions, Hello},
    io::{IoValue, Signal},
    refusal::Refusal,
    request::Id,
    robot_identity::RobotIdentity,
    text::to_json,
};

/// State of iiwaDrive and the robot (Larsen 2019, section 3.1.1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DriveState {
    /// At rest; requests are accepted.
    #[default]
    Idle,
    /// Running motions that the controller has planned.
    RunningMotion,
    /// Running a trajectory that is commanded over FRI.
    RunningTrajectory,
}

impl DriveState {
    /// Returns the name in JSON, in snake case.
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
#[non_exhaustive]
pub struct MeasuredPositions {
    /// Time stamps, in s, as in the stream: the controller time since its first message to
    /// iiwaDrive.
    pub t_s: Vec<f64>,
    /// Positions at these times, in rad; one per time stamp.
    pub joints_rad: Vec<Joints>,
}

impl MeasuredPositions {
    /// Creates samples from times, in s, and positions, in rad.
    #[must_use]
    pub fn new(t_s: Vec<f64>, joints_rad: Vec<Joints>) -> Self {
        Self { t_s, joints_rad }
    }
}

/// Measurements of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Run {
    /// Time from the start to the end of the run, in s, if both are known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycle_time_s: Option<f64>,
    /// Start of the run, in s on the time scale of the samples, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_s: Option<f64>,
    /// Source of start and end; `None` for the clock of the robot program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timed_by: Option<TimedBy>,
    /// The reason for a missing cycle time, if the run succeeded without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub untimed_because: Option<String>,
    /// Measurements over FRI, from just before the start to the end, and up to 0.25 s longer if the
    /// end is taken from the commanded positions: the robot arrives after them.
    #[serde(default)]
    pub samples: MeasuredPositions,
    /// Number of samples beyond [`MAX_SAMPLES`](super::MAX_SAMPLES), which are not stored.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub samples_left_out: u64,
}

impl Run {
    /// Creates a run with samples only.
    #[must_use]
    pub fn new(samples: MeasuredPositions) -> Self {
        Self { samples, ..Self::default() }
    }
}

/// Source of the times of a run, if not the clock of the robot program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum TimedBy {
    /// The first and the last change of the joint positions that the controller commands.
    /// Standstill before and after, such as the settling time, is excluded.
    CommandedPosition,
}

impl TimedBy {
    /// Returns the name in JSON, in snake case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::CommandedPosition => "commanded_position",
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde requires")]
fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// Readings of the robot's sensors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Sensors {
    /// Joint temperatures, in degrees Celsius; `None` if the controller does not report them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint_temperature_c: Option<Joints>,
    /// External joint torques, in Nm.
    pub external_torque_nm: Joints,
}

impl Sensors {
    /// Creates readings from joint temperatures, in degrees Celsius, if known, and external joint
    /// torques, in Nm.
    #[must_use]
    pub fn new(joint_temperature_c: Option<Joints>, external_torque_nm: Joints) -> Self {
        Self { joint_temperature_c, external_torque_nm }
    }
}

/// Status of the FRI connection to the controller.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct FriStatus {
    /// Session state, such as `monitoring_ready`; `silent` if no messages arrive.
    pub session: String,
    /// Connection quality rated by the controller: `poor`, `fair`, `good` or `excellent`.
    pub quality: String,
    /// Number of controller messages that did not arrive.
    pub lost: u64,
    /// Number of messages that arrived after a later one.
    pub late: u64,
    /// `true` if the safety controller demands a stop, such as while the emergency stop is pressed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub safety_stop: bool,
    /// The unexpected source address of FRI messages, while none arrive from the expected one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unexpected_source: Option<IpAddr>,
}

impl FriStatus {
    /// Value of `session` for a controller that does not send.
    pub const SILENT: &str = "silent";

    /// Creates a status from a session state and the controller's rating, without losses.
    #[must_use]
    pub fn new(session: &str, quality: &str) -> Self {
        Self { session: session.to_owned(), quality: quality.to_owned(), ..Self::default() }
    }
}

/// A snapshot of the drive and the robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct DriveStatus {
    /// The state of the drive.
    pub state: DriveState,
    /// The robot that the drive is configured for; `None` from a drive of an older version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<RobotIdentity>,
    /// Measured joint positions, in rad; `None` before the controller's first message.
    pub joints_rad: Option<Joints>,
    /// Time of the joint position measurement, in s.
    pub t_s: Option<f64>,
    /// The FRI connection.
    pub fri: FriStatus,
    /// Connection state of the robot program.
    #[serde(default)]
    pub robot_program: Presence,
    /// `true` if the robot program reports a simulated robot.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
    /// Versions of the robot program, if reported.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hello: Option<Hello>,
    /// Controller conditions, if reported by the robot program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<Conditions>,
}

impl DriveStatus {
    /// Creates the status of a drive that has not received any data from the robot.
    #[must_use]
    pub fn new(state: DriveState, fri: FriStatus) -> Self {
        Self {
            state,
            robot: None,
            joints_rad: None,
            t_s: None,
            fri,
            robot_program: Presence::Silent,
            simulated: false,
            hello: None,
            conditions: None,
        }
    }
}

/// Connection state of a peer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Presence {
    /// No message has arrived within the time-out.
    #[default]
    Silent,
    /// Messages arrive.
    Connected,
}

/// Content of a reply.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum ReplyBody {
    /// Reply to runs, including aborted ones, and to `last_run`.
    Run(Run),
    /// Reply to `state`.
    Status(Box<DriveStatus>),
    /// Reply to `read_sensors`.
    Sensors {
        /// The readings.
        sensors: Sensors,
    },
    /// Reply to `list_io`.
    Signals {
        /// All inputs and outputs.
        io: Vec<Signal>,
    },
    /// Reply to `get_io` and `set_io`.
    Value {
        /// The current value.
        value: IoValue,
    },
}

/// Reply to a request.
///
/// ```
/// use iiwa_link::message::{Refusal, Reply};
///
/// assert_eq!(Reply::default().to_json(), r#"{"ok":true}"#);
/// let refusal = Refusal::robot("the emergency stop is pressed");
/// let reply = Reply { error: Some(&refusal), ..Reply::default() };
/// assert!(reply.to_json().starts_with(r#"{"ok":false,"error":{"code":"robot","#));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Reply<'a> {
    /// Id of the request.
    pub id: Option<&'a Id>,
    /// The reason why the request was not, or not completely, carried out.
    pub error: Option<&'a Refusal>,
    /// The requested content.
    pub body: Option<&'a ReplyBody>,
}

impl Reply<'_> {
    /// Returns the reply as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        #[derive(Serialize)]
        struct ReplyJson<'a> {
            ok: bool,
            #[serde(skip_serializing_if = "Option::is_none")]
            id: Option<&'a Id>,
            #[serde(skip_serializing_if = "Option::is_none")]
            error: Option<&'a Refusal>,
            #[serde(flatten)]
            body: Option<&'a ReplyBody>,
        }
        let Self { id, error, body } = *self;
        to_json(&ReplyJson { ok: error.is_none(), id, error, body })
    }
}
