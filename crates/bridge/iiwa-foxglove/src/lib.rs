//! Publishes a KUKA LBR iiwa live to Foxglove and Lichtblick.
//!
//! Viewers connect to a WebSocket and find the topics of a recording, with the same types, so that
//! a layout created for one works for the other; and the drive state, as JSON. Viewers have read
//! access only: the server does not allow them to publish, set parameters or call services. There
//! is no authentication, so the server should listen to this machine only. (Any web page in a
//! browser on this machine can connect; viewers that are web pages connect in this way.)
//!
//! Viewers need the protocol `foxglove.sdk.v1`, which Foxglove and newer versions of Lichtblick
//! support.

mod audience;
mod protocol;
mod schema;
mod server;

use std::{
    error::Error,
    net::SocketAddr,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use iiwa_kin::{Joints, Robot, RosNames};
use iiwa_link::message::{DriveStatus, IoValue, Sensors};
use iiwa_log::{Arm, Encoder, FramePose, Topic, WriteError};
use serde::Serialize;
use serde_json::{Value, json};

use self::{protocol::Channel, server::FoxgloveServer};

/// Maximum number of published joint states per second: more than a screen shows, and a divisor of
/// the usual stream rates.
const RATE_HZ: u32 = 100;

/// Numbers of the advertised channels.
const JOINT_STATES: u64 = 1;
const TF: u64 = 2;
const TCP_POSE: u64 = 3;
const ROBOT_DESCRIPTION: u64 = 4;
const DRIVE_STATE: u64 = 5;
const SENSORS: u64 = 6;
const INPUTS_OUTPUTS: u64 = 7;

/// Error of serving viewers.
#[derive(Debug, thiserror::Error)]
#[error("{operation}: {cause}")]
pub struct ViewersError {
    /// The failed operation.
    pub operation: String,
    /// The cause.
    pub cause: Box<dyn Error + Send + Sync>,
}

impl ViewersError {
    fn new(operation: impl Into<String>, cause: impl Error + Send + Sync + 'static) -> Self {
        Self { operation: operation.into(), cause: Box::new(cause) }
    }
}

/// A server for viewers. Dropping it disconnects them and closes the port.
///
/// The server has a separate thread. [`Self::listen`] and the drop block, so asynchronous code must
/// not call them.
pub struct Viewers {
    encoder: Encoder,
    arm: Arm,
    last: Option<PublishedJoints>,
    server: FoxgloveServer,
}

/// The joint state published last.
#[derive(Clone, Copy)]
struct PublishedJoints {
    /// Time since 1970.
    t: Duration,
    joints_rad: Joints,
}

impl Viewers {
    /// Listens at `address` for viewers of `robot`, whose joints and links have these names; port 0
    /// selects a free port.
    ///
    /// # Errors
    ///
    /// [`ViewersError`] if the address is in use, or does not belong to this machine.
    pub fn listen(
        robot: &Robot,
        names: &RosNames,
        address: SocketAddr,
    ) -> Result<Self, ViewersError> {
        let mut encoder = Encoder::with_names(Duration::ZERO, names).map_err(unencoded)?;
        let arm = Arm::with_names(robot, names);
        let channels = vec![
            ros_channel(JOINT_STATES, Topic::JointStates),
            ros_channel(TF, Topic::Tf),
            ros_channel(TCP_POSE, Topic::TcpPose),
            ros_channel(ROBOT_DESCRIPTION, Topic::RobotDescription),
            json_channel(DRIVE_STATE, "/drive_state", "DriveState", &schema::drive_state()),
            json_channel(SENSORS, "/sensors", "Sensors", &schema::sensors()),
            json_channel(
                INPUTS_OUTPUTS,
                "/inputs_outputs",
                "InputsOutputs",
                &schema::inputs_outputs(),
            ),
        ];
        let server = FoxgloveServer::listen(address, channels).map_err(|error| {
            ViewersError::new(format!("cannot listen for viewers at {address}"), error)
        })?;
        let description = encoder.robot_description(arm.urdf()).map_err(unencoded)?.to_vec();
        let now_ns = nanoseconds(since_1970(SystemTime::now()));
        server.audience().latch(ROBOT_DESCRIPTION, now_ns, description);
        Ok(Self { encoder, arm, last: None, server })
    }

    /// Returns the bound address.
    pub fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// Publishes a sample, with positions in rad: the joint state, the link frames and the flange
    /// pose. Of the samples in each hundredth of a second, only the first one is published.
    ///
    /// The velocities are means since the previously published sample.
    ///
    /// # Errors
    ///
    /// [`ViewersError`] if a message cannot be encoded, such as for a time that its format cannot
    /// represent.
    pub fn joints(&mut self, time: SystemTime, joints_rad: &Joints) -> Result<(), ViewersError> {
        let t = since_1970(time);
        let slot = |t: Duration| t.as_nanos() * u128::from(RATE_HZ) / 1_000_000_000;
        if self.last.is_some_and(|last| slot(last.t) == slot(t)) {
            return Ok(());
        }
        let before = self.last.replace(PublishedJoints { t, joints_rad: *joints_rad });
        self.publish(t, joints_rad, &mean_velocities(before.as_ref(), t, joints_rad))
            .map_err(unencoded)
    }

    fn publish(
        &mut self,
        t: Duration,
        joints_rad: &Joints,
        velocities: &Joints,
    ) -> Result<(), WriteError> {
        let Self { encoder, arm, server, .. } = self;
        let audience = server.audience();
        let stamp_ns = nanoseconds(t);
        // Encoded only for topics that have subscribers.
        if audience.has_viewers(JOINT_STATES) {
            let state = encoder.joint_state(t, joints_rad, velocities, None)?;
            audience.publish(JOINT_STATES, stamp_ns, state);
        }
        if audience.has_viewers(TF) {
            audience.publish(TF, stamp_ns, encoder.transforms(t, &arm.links(joints_rad))?);
        }
        if audience.has_viewers(TCP_POSE) {
            let FramePose { parent, translation_m, rotation_xyzw, .. } = arm.flange(joints_rad);
            let pose = encoder.tcp_pose(t, parent, translation_m, rotation_xyzw)?;
            audience.publish(TCP_POSE, stamp_ns, pose);
        }
        Ok(())
    }

    /// Publishes the drive and robot status on `/drive_state`.
    pub fn drive_state(&self, time: SystemTime, status: &DriveStatus) {
        self.publish_json(DRIVE_STATE, time, status);
    }

    /// Publishes the sensor values on `/sensors`.
    pub fn sensors(&self, time: SystemTime, sensors: &Sensors) {
        self.publish_json(SENSORS, time, sensors);
    }

    /// Publishes the values of inputs and outputs, by name, on `/inputs_outputs`. Booleans become 0
    /// or 1, which viewers can plot.
    pub fn inputs_outputs(&self, time: SystemTime, values: &[(&str, IoValue)]) {
        let number = |value: IoValue| match value {
            IoValue::Boolean(value) => u8::from(value).into(),
            IoValue::Digital(value) => value.into(),
            IoValue::Analog(value) => Value::from(value),
        };
        let entries =
            values.iter().map(|(name, value)| json!({ "name": name, "value": number(*value) }));
        self.publish_json(INPUTS_OUTPUTS, time, &json!({ "values": entries.collect::<Value>() }));
    }

    /// Publishes a message as JSON, without unknown values: in viewers, each field has one type,
    /// and null would be another.
    fn publish_json(&self, channel: u64, time: SystemTime, message: &impl Serialize) {
        let Ok(mut message) = serde_json::to_value(message) else { return };
        if let Value::Object(fields) = &mut message {
            fields.retain(|_, value| !value.is_null());
        }
        let text = message.to_string().into_bytes();
        self.server.audience().latch(channel, nanoseconds(since_1970(time)), text);
    }
}

/// Creates a channel for a topic of a recording.
fn ros_channel(id: u64, topic: Topic) -> Channel {
    Channel {
        id,
        topic: topic.name().to_owned(),
        encoding: Topic::MESSAGE_ENCODING,
        schema_name: topic.type_name().to_owned(),
        schema: topic.schema(),
        schema_encoding: Topic::SCHEMA_ENCODING,
    }
}

/// Creates a channel for a JSON topic.
fn json_channel(id: u64, topic: &str, type_name: &str, schema: &Value) -> Channel {
    Channel {
        id,
        topic: topic.to_owned(),
        encoding: "json",
        schema_name: format!("iiwasim.{type_name}"),
        schema: schema.to_string(),
        schema_encoding: "jsonschema",
    }
}

/// Returns mean velocities since the previous sample, in rad/s; zero without one.
fn mean_velocities(before: Option<&PublishedJoints>, t: Duration, joints_rad: &Joints) -> Joints {
    let Some(before) = before else { return [0.0; 7] };
    // The clock may have been set back.
    let Some(span) = t.checked_sub(before.t).filter(|span| !span.is_zero()) else {
        return [0.0; 7];
    };
    let span_s = span.as_secs_f64();
    std::array::from_fn(|joint| (joints_rad[joint] - before.joints_rad[joint]) / span_s)
}

fn since_1970(time: SystemTime) -> Duration {
    time.duration_since(UNIX_EPOCH).unwrap_or_default()
}

fn nanoseconds(t: Duration) -> u64 {
    u64::try_from(t.as_nanos()).unwrap_or(u64::MAX)
}

fn unencoded(error: WriteError) -> ViewersError {
    ViewersError::new("cannot publish to viewers", error)
}
