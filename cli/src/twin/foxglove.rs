//! Publishes the robot live to Foxglove and Lichtblick.
//!
//! Viewers connect to a WebSocket and find the topics of a recording, with the same types, so that a
//! layout made for one works for the other; and the state of the drive, as JSON. They only read: the
//! server does not allow them to publish, set parameters or call services. There is no authentication,
//! and so the server should listen to this machine only. (Any web page in a browser on this machine
//! can connect, which is how viewers that are web pages do it.)
//!
//! Viewers need the protocol `foxglove.sdk.v1`, as in Foxglove and newer versions of Lichtblick.

mod latched;
mod schema;

use std::{
    error::Error,
    net::SocketAddr,
    sync::Arc,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use foxglove::{
    Context, FoxgloveError, PartialMetadata, RawChannel, Schema, WebSocketServerHandle,
};
use iiwa_kin::{Joints, Robot};
use iiwa_link::message::{IoValue, Sensors, Status};
use iiwa_log::{Arm, Encoder, Frame, Topic, WriteError};
use serde::Serialize;
use serde_json::{Value, json};
use tokio::{
    runtime::{self, Runtime},
    time::timeout,
};

use self::latched::{Latched, LateViewers};

/// Joint states a second that are published, at most: more than a screen shows, and a divisor of the
/// usual rates of streams.
const RATE_HZ: u32 = 100;

/// Messages queued for a slow viewer, less than two seconds and a megabyte of them; then the oldest are
/// dropped.
const BACKLOG: usize = 512;

/// How long to wait for viewers to disconnect. One that does not read never would.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_millis(200);

/// Why viewers cannot be served.
#[derive(Debug, thiserror::Error)]
#[error("{what}: {cause}")]
pub(crate) struct ViewersError {
    pub(crate) what: String,
    pub(crate) cause: Box<dyn Error + Send + Sync>,
}

impl ViewersError {
    fn new(what: impl Into<String>, cause: impl Error + Send + Sync + 'static) -> Self {
        Self { what: what.into(), cause: Box::new(cause) }
    }
}

/// A server for viewers. When dropped, it disconnects them and closes the port.
///
/// It has a thread of its own. [`Self::listen`] and the drop block, so that asynchronous code must not call
/// them.
pub(crate) struct Viewers {
    encoder: Encoder,
    arm: Arm,
    joint_states: Arc<RawChannel>,
    tf: Arc<RawChannel>,
    tcp_pose: Arc<RawChannel>,
    drive_state: Arc<Latched>,
    sensors: Arc<Latched>,
    inputs_outputs: Arc<Latched>,
    last: Option<Sample>,
    address: SocketAddr,
    /// None once it is stopped.
    server: Option<WebSocketServerHandle>,
    /// Keeps the channels open.
    _context: Arc<Context>,
    /// Its thread serves the viewers.
    runtime: Runtime,
}

/// The joint state published last.
#[derive(Clone, Copy)]
struct Sample {
    /// Since 1970.
    t: Duration,
    joints_rad: Joints,
}

impl Viewers {
    /// Listens at `at` for viewers of `robot`; port 0 takes a free one.
    pub(crate) fn listen(robot: &Robot, at: SocketAddr) -> Result<Self, ViewersError> {
        let mut encoder = Encoder::new(Duration::ZERO).map_err(unencoded)?;
        let arm = Arm::new(robot);
        let context = Context::new();
        let ros = |topic: Topic| ros_channel(&context, topic).map_err(|error| refused(at, error));
        let json_topic = |topic: &str, type_name: &str, schema: &Value| {
            let schema = Schema::new(type_name, "jsonschema", schema.to_string().into_bytes());
            let channel = context.channel_builder(topic).message_encoding("json").schema(schema);
            let channel = channel.build_raw().map_err(|error| refused(at, error))?;
            Ok::<_, ViewersError>(Arc::new(Latched::new(channel)))
        };
        let [joint_states, tf, tcp_pose] =
            [ros(Topic::JointStates)?, ros(Topic::Tf)?, ros(Topic::TcpPose)?];
        let description = Arc::new(Latched::new(ros(Topic::RobotDescription)?));
        let message = encoder.robot_description(arm.urdf()).map_err(unencoded)?.to_vec();
        description.publish(nanoseconds(since_1970(SystemTime::now())), message);
        let drive_state = json_topic("/drive_state", "iiwasim.DriveState", &schema::drive_state())?;
        let sensors = json_topic("/sensors", "iiwasim.Sensors", &schema::sensors())?;
        let inputs_outputs =
            json_topic("/inputs_outputs", "iiwasim.InputsOutputs", &schema::inputs_outputs())?;

        let runtime = runtime::Builder::new_multi_thread()
            .worker_threads(1)
            .thread_name("viewers")
            .enable_all()
            .build()
            .map_err(|error| ViewersError::new("cannot serve viewers", error))?;
        let host = match at {
            SocketAddr::V4(at) => at.ip().to_string(),
            SocketAddr::V6(at) => format!("[{}]", at.ip()),
        };
        let latched =
            [&description, &drive_state, &sensors, &inputs_outputs].map(Arc::clone).into();
        let server = context
            .websocket_server()
            .name("iiwasim")
            .bind(host, at.port())
            // Viewers only read.
            .capabilities([])
            .message_backlog_size(BACKLOG)
            .listener(Arc::new(LateViewers(latched)));
        let server = runtime.block_on(server.start()).map_err(|error| refused(at, error))?;

        Ok(Self {
            encoder,
            arm,
            joint_states,
            tf,
            tcp_pose,
            drive_state,
            sensors,
            inputs_outputs,
            last: None,
            address: SocketAddr::new(at.ip(), server.port()),
            server: Some(server),
            _context: context,
            runtime,
        })
    }

    /// The address at which it listens.
    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Publishes a sample, with positions in rad: the joint state, the frames of the links and the pose of the
    /// flange. Of the samples of each hundredth of a second, only the first one is published.
    ///
    /// The velocities are the mean ones since the sample published before.
    pub(crate) fn joints(
        &mut self,
        at: SystemTime,
        joints_rad: &Joints,
    ) -> Result<(), ViewersError> {
        let t = since_1970(at);
        let slot = |t: Duration| t.as_nanos() * u128::from(RATE_HZ) / 1_000_000_000;
        if self.last.is_some_and(|last| slot(last.t) == slot(t)) {
            return Ok(());
        }
        let before = self.last.replace(Sample { t, joints_rad: *joints_rad });
        self.publish(t, joints_rad, &mean_velocities(before.as_ref(), t, joints_rad))
            .map_err(unencoded)
    }

    fn publish(
        &mut self,
        t: Duration,
        joints_rad: &Joints,
        velocities: &Joints,
    ) -> Result<(), WriteError> {
        let Self { encoder, arm, joint_states, tf, tcp_pose, .. } = self;
        let at = PartialMetadata::with_log_time(nanoseconds(t));
        // Encoded only for topics that have subscribers.
        if joint_states.has_sinks() {
            joint_states.log_with_meta(encoder.joint_state(t, joints_rad, velocities)?, at);
        }
        if tf.has_sinks() {
            tf.log_with_meta(encoder.transforms(t, &arm.links(joints_rad))?, at);
        }
        if tcp_pose.has_sinks() {
            let Frame { parent, translation_m, rotation_xyzw, .. } = arm.flange(joints_rad);
            let pose = encoder.tcp_pose(t, parent, translation_m, rotation_xyzw)?;
            tcp_pose.log_with_meta(pose, at);
        }
        Ok(())
    }

    /// Publishes the status of the drive and the robot on `/drive_state`.
    pub(crate) fn drive_state(&self, at: SystemTime, status: &Status) {
        publish_json(&self.drive_state, at, status);
    }

    /// Publishes the values of the sensors on `/sensors`.
    pub(crate) fn sensors(&self, at: SystemTime, sensors: &Sensors) {
        publish_json(&self.sensors, at, sensors);
    }

    /// Publishes the values of inputs and outputs, by name, on `/inputs_outputs`. Booleans become 0 or 1,
    /// which viewers can plot.
    pub(crate) fn inputs_outputs(&self, at: SystemTime, values: &[(&str, IoValue)]) {
        let number = |value: IoValue| match value {
            IoValue::Boolean(value) => u8::from(value).into(),
            IoValue::Digital(value) => value.into(),
            IoValue::Analog(value) => Value::from(value),
        };
        let entries =
            values.iter().map(|(name, value)| json!({ "name": name, "value": number(*value) }));
        publish_json(&self.inputs_outputs, at, &json!({ "values": entries.collect::<Value>() }));
    }
}

impl Drop for Viewers {
    fn drop(&mut self) {
        if let Some(server) = self.server.take() {
            let stopped = server.stop();
            // Viewers still connected after it are cut off.
            let _ =
                self.runtime.block_on(async { timeout(SHUTDOWN_TIMEOUT, stopped.wait()).await });
        }
    }
}

/// A topic of a recording.
fn ros_channel(context: &Arc<Context>, topic: Topic) -> Result<Arc<RawChannel>, FoxgloveError> {
    let schema =
        Schema::new(topic.type_name(), Topic::SCHEMA_ENCODING, topic.schema().into_bytes());
    context
        .channel_builder(topic.name())
        .message_encoding(Topic::MESSAGE_ENCODING)
        .schema(schema)
        .build_raw()
}

/// Publishes a message as JSON, without unknown fields: for viewers a field has one type, and null is
/// another.
fn publish_json(channel: &Latched, at: SystemTime, message: &impl Serialize) {
    let Ok(mut message) = serde_json::to_value(message) else { return };
    if let Value::Object(fields) = &mut message {
        fields.retain(|_, value| !value.is_null());
    }
    channel.publish(nanoseconds(since_1970(at)), message.to_string().into_bytes());
}

/// Mean velocities since the sample before, in rad/s; zero without one.
fn mean_velocities(before: Option<&Sample>, t: Duration, joints_rad: &Joints) -> Joints {
    let Some(before) = before else { return [0.0; 7] };
    // The clock may have been set back.
    let Some(span) = t.checked_sub(before.t).filter(|span| !span.is_zero()) else {
        return [0.0; 7];
    };
    let span_s = span.as_secs_f64();
    std::array::from_fn(|joint| (joints_rad[joint] - before.joints_rad[joint]) / span_s)
}

fn since_1970(at: SystemTime) -> Duration {
    at.duration_since(UNIX_EPOCH).unwrap_or_default()
}

fn nanoseconds(t: Duration) -> u64 {
    u64::try_from(t.as_nanos()).unwrap_or(u64::MAX)
}

fn refused(at: SocketAddr, error: FoxgloveError) -> ViewersError {
    let what = format!("cannot listen for viewers at {at}");
    match error {
        FoxgloveError::Bind(error) => ViewersError::new(what, error),
        error => ViewersError::new(what, error),
    }
}

fn unencoded(error: WriteError) -> ViewersError {
    ViewersError::new("cannot publish to viewers", error)
}
