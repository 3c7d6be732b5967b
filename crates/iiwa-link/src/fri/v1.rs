//! The bytes of FRI 1.14 to 1.16: protobuf (proto2), one message a datagram.

use std::time::Duration;

use iiwa_kin::Joints;
use prost::Message;

use super::{
    Command, CommandMode, ControlMode, Drive, Monitoring, OperationMode, Overlay, Quality, Safety,
    SessionState, WireError,
};

/// Message identifier of the controller's messages.
const MONITORING: u32 = 0x0024_5142;
/// Message identifier of the client's answers.
const COMMAND: u32 = 0x0003_4001;

// What stands for what: the number on the wire is the place in the list.
const SESSION_STATES: &[SessionState] = &[
    SessionState::Idle,
    SessionState::MonitoringWait,
    SessionState::MonitoringReady,
    SessionState::CommandingWait,
    SessionState::CommandingActive,
];
const QUALITIES: &[Quality] = &[Quality::Poor, Quality::Fair, Quality::Good, Quality::Excellent];
const SAFETY: &[Safety] = &[Safety::Normal, Safety::Stop0, Safety::Stop1, Safety::Stop2];
const OPERATION_MODES: &[OperationMode] =
    &[OperationMode::T1, OperationMode::T2, OperationMode::Automatic];
const DRIVES: &[Drive] = &[Drive::Off, Drive::Transitioning, Drive::Active];
const CONTROL_MODES: &[ControlMode] = &[
    ControlMode::Position,
    ControlMode::CartesianImpedance,
    ControlMode::JointImpedance,
    ControlMode::None,
];
const COMMAND_MODES: &[CommandMode] =
    &[CommandMode::None, CommandMode::Position, CommandMode::Wrench, CommandMode::Torque];
const OVERLAYS: &[Overlay] = &[Overlay::None, Overlay::Joint, Overlay::Cartesian];

// Every field is an option here: prost would take a required one that is missing for a zero.

#[derive(Clone, PartialEq, Message)]
struct MonitoringMessage {
    #[prost(message, optional, tag = "1")]
    header: Option<Header>,
    #[prost(message, optional, tag = "2")]
    robot: Option<RobotInfo>,
    #[prost(message, optional, tag = "3")]
    monitor: Option<MonitorData>,
    #[prost(message, optional, tag = "4")]
    connection: Option<ConnectionInfo>,
    #[prost(message, optional, tag = "5")]
    ipo: Option<IpoData>,
}

#[derive(Clone, PartialEq, Message)]
struct CommandMessage {
    #[prost(message, optional, tag = "1")]
    header: Option<Header>,
    #[prost(message, optional, tag = "2")]
    data: Option<CommandData>,
}

#[derive(Clone, Copy, PartialEq, Message)]
struct Header {
    #[prost(uint32, optional, tag = "1")]
    identifier: Option<u32>,
    #[prost(uint32, optional, tag = "2")]
    sequence: Option<u32>,
    #[prost(uint32, optional, tag = "3")]
    reflected: Option<u32>,
}

#[derive(Clone, Copy, PartialEq, Message)]
struct ConnectionInfo {
    #[prost(int32, optional, tag = "1")]
    session: Option<i32>,
    #[prost(int32, optional, tag = "2")]
    quality: Option<i32>,
    #[prost(uint32, optional, tag = "3")]
    send_period_ms: Option<u32>,
    #[prost(uint32, optional, tag = "4")]
    receive_multiplier: Option<u32>,
}

#[derive(Clone, PartialEq, Message)]
struct RobotInfo {
    #[prost(int32, optional, tag = "1")]
    joints: Option<i32>,
    #[prost(int32, optional, tag = "2")]
    safety: Option<i32>,
    #[prost(int32, repeated, packed = "false", tag = "5")]
    drives: Vec<i32>,
    #[prost(int32, optional, tag = "6")]
    operation_mode: Option<i32>,
    #[prost(int32, optional, tag = "7")]
    control_mode: Option<i32>,
}

#[derive(Clone, PartialEq, Message)]
struct MonitorData {
    #[prost(message, optional, tag = "1")]
    measured: Option<JointValues>,
    #[prost(message, optional, tag = "2")]
    measured_torque: Option<JointValues>,
    #[prost(message, optional, tag = "3")]
    commanded: Option<JointValues>,
    #[prost(message, optional, tag = "4")]
    commanded_torque: Option<JointValues>,
    #[prost(message, optional, tag = "5")]
    external_torque: Option<JointValues>,
    #[prost(message, optional, tag = "15")]
    time: Option<TimeStamp>,
}

#[derive(Clone, PartialEq, Message)]
struct IpoData {
    #[prost(message, optional, tag = "1")]
    joints: Option<JointValues>,
    #[prost(int32, optional, tag = "10")]
    command_mode: Option<i32>,
    #[prost(int32, optional, tag = "11")]
    overlay: Option<i32>,
    #[prost(double, optional, tag = "12")]
    tracking_performance: Option<f64>,
}

#[derive(Clone, PartialEq, Message)]
struct CommandData {
    #[prost(message, optional, tag = "1")]
    joints: Option<JointValues>,
}

#[derive(Clone, PartialEq, Message)]
struct JointValues {
    // Readers of the controller's kind take one tag a value and nothing else.
    #[prost(double, repeated, packed = "false", tag = "1")]
    values: Vec<f64>,
}

#[derive(Clone, Copy, PartialEq, Message)]
struct TimeStamp {
    #[prost(uint32, optional, tag = "1")]
    seconds: Option<u32>,
    #[prost(uint32, optional, tag = "2")]
    nanoseconds: Option<u32>,
}

pub(super) fn encode_monitoring(message: &Monitoring, out: &mut Vec<u8>) {
    let Monitoring { safety, operation_mode, drive, control_mode, .. } = *message;
    let has_robot =
        safety.is_some() || operation_mode.is_some() || drive.is_some() || control_mode.is_some();
    let monitor = MonitorData {
        measured: values(message.measured_rad.as_ref()),
        measured_torque: values(message.measured_torque_nm.as_ref()),
        commanded: values(message.commanded_rad.as_ref()),
        commanded_torque: values(message.commanded_torque_nm.as_ref()),
        external_torque: values(message.external_torque_nm.as_ref()),
        time: message.time.map(TimeStamp::new),
    };
    let ipo = IpoData {
        joints: values(message.ipo_rad.as_ref()),
        command_mode: message.command_mode.map(|mode| number(COMMAND_MODES, mode)),
        overlay: message.overlay.map(|overlay| number(OVERLAYS, overlay)),
        tracking_performance: message.tracking_performance,
    };
    let message = MonitoringMessage {
        header: Some(Header::new(MONITORING, message.sequence, message.reflected)),
        robot: has_robot.then(|| RobotInfo {
            joints: Some(7),
            safety: safety.map(|safety| number(SAFETY, safety)),
            drives: drive.map_or_else(Vec::new, |drive| vec![number(DRIVES, drive); 7]),
            operation_mode: operation_mode.map(|mode| number(OPERATION_MODES, mode)),
            control_mode: control_mode.map(|mode| number(CONTROL_MODES, mode)),
        }),
        monitor: (monitor != MonitorData::default()).then_some(monitor),
        connection: Some(ConnectionInfo {
            session: Some(number(SESSION_STATES, message.session)),
            quality: Some(number(QUALITIES, message.quality)),
            send_period_ms: Some(message.send_period_ms),
            receive_multiplier: Some(message.receive_multiplier),
        }),
        ipo: (ipo != IpoData::default()).then_some(ipo),
    };
    message.encode_raw(out);
}

pub(super) fn decode_monitoring(datagram: &[u8]) -> Result<Monitoring, WireError> {
    let message = MonitoringMessage::decode(datagram)?;
    let (sequence, reflected) = counters(message.header, MONITORING)?;
    let connection = required(message.connection, "connectionInfo")?;
    let receive_multiplier = connection.receive_multiplier.unwrap_or(1);
    if receive_multiplier == 0 {
        return Err(WireError::ReceiveMultiplier);
    }
    let session = required(connection.session, "connectionInfo.sessionState")?;
    let quality = required(connection.quality, "connectionInfo.quality")?;
    let robot = message.robot.unwrap_or_default();
    let monitor = message.monitor.unwrap_or_default();
    let ipo = message.ipo.unwrap_or_default();
    if ipo.tracking_performance.is_some_and(|share| !share.is_finite()) {
        return Err(WireError::NotFinite { field: "ipoData.trackingPerformance" });
    }
    let mut drive = None;
    for &found in &robot.drives {
        let next = state(DRIVES, found, "robotInfo.driveState")?;
        drive = Some(drive.map_or(next, |drive| next.min(drive)));
    }
    Ok(Monitoring {
        sequence,
        reflected,
        session: state(SESSION_STATES, session, "connectionInfo.sessionState")?,
        quality: state(QUALITIES, quality, "connectionInfo.quality")?,
        send_period_ms: connection.send_period_ms.unwrap_or(0),
        receive_multiplier,
        safety: optional(SAFETY, robot.safety, "robotInfo.safetyState")?,
        operation_mode: optional(OPERATION_MODES, robot.operation_mode, "robotInfo.operationMode")?,
        drive,
        control_mode: optional(CONTROL_MODES, robot.control_mode, "robotInfo.controlMode")?,
        measured_rad: joints(monitor.measured, "monitorData.measuredJointPosition")?,
        measured_torque_nm: joints(monitor.measured_torque, "monitorData.measuredTorque")?,
        commanded_rad: joints(monitor.commanded, "monitorData.commandedJointPosition")?,
        commanded_torque_nm: joints(monitor.commanded_torque, "monitorData.commandedTorque")?,
        external_torque_nm: joints(monitor.external_torque, "monitorData.externalTorque")?,
        ipo_rad: joints(ipo.joints, "ipoData.jointPosition")?,
        command_mode: optional(COMMAND_MODES, ipo.command_mode, "ipoData.clientCommandMode")?,
        overlay: optional(OVERLAYS, ipo.overlay, "ipoData.overlayType")?,
        tracking_performance: ipo.tracking_performance,
        time: monitor.time.map(TimeStamp::duration).transpose()?,
    })
}

pub(super) fn encode_command(message: &Command, out: &mut Vec<u8>) {
    let data =
        message.joints_rad.as_ref().map(|joints| CommandData { joints: values(Some(joints)) });
    let header = Some(Header::new(COMMAND, message.sequence, message.reflected));
    CommandMessage { header, data }.encode_raw(out);
}

pub(super) fn decode_command(datagram: &[u8]) -> Result<Command, WireError> {
    let message = CommandMessage::decode(datagram)?;
    let (sequence, reflected) = counters(message.header, COMMAND)?;
    let joints_rad = match message.data {
        Some(data) => joints(data.joints, "commandData.jointPosition")?,
        None => None,
    };
    Ok(Command { sequence, reflected, joints_rad })
}

impl Header {
    const fn new(identifier: u32, sequence: u32, reflected: u32) -> Self {
        Self { identifier: Some(identifier), sequence: Some(sequence), reflected: Some(reflected) }
    }
}

impl TimeStamp {
    /// The stamp's seconds have 32 bits on the wire, which is enough until 2106; later ones wrap.
    #[expect(clippy::cast_possible_truncation, reason = "the wire has no more bits")]
    fn new(time: Duration) -> Self {
        Self { seconds: Some(time.as_secs() as u32), nanoseconds: Some(time.subsec_nanos()) }
    }

    fn duration(self) -> Result<Duration, WireError> {
        let seconds = required(self.seconds, "monitorData.timestamp.sec")?;
        let nanoseconds = required(self.nanoseconds, "monitorData.timestamp.nanosec")?;
        Ok(Duration::from_secs(seconds.into()) + Duration::from_nanos(nanoseconds.into()))
    }
}

/// The counters of a header: the sender's own, and the reflected one.
fn counters(header: Option<Header>, expected: u32) -> Result<(u32, u32), WireError> {
    let header = required(header, "header")?;
    let found = required(header.identifier, "header.messageIdentifier")?;
    if found != expected {
        return Err(WireError::Identifier { expected, found });
    }
    let sequence = required(header.sequence, "header.sequenceCounter")?;
    let reflected = required(header.reflected, "header.reflectedSequenceCounter")?;
    Ok((sequence, reflected))
}

fn required<T>(value: Option<T>, field: &'static str) -> Result<T, WireError> {
    value.ok_or(WireError::Missing { field })
}

fn values(joints: Option<&Joints>) -> Option<JointValues> {
    joints.map(|joints| JointValues { values: joints.to_vec() })
}

fn joints(values: Option<JointValues>, field: &'static str) -> Result<Option<Joints>, WireError> {
    let Some(JointValues { values }) = values else { return Ok(None) };
    let joints = Joints::try_from(values.as_slice())
        .map_err(|_| WireError::JointCount { field, found: values.len() })?;
    if !joints.iter().all(|value| value.is_finite()) {
        return Err(WireError::NotFinite { field });
    }
    Ok(Some(joints))
}

/// The number that stands for `state`.
fn number<T: Copy + Eq>(states: &[T], state: T) -> i32 {
    states.iter().zip(0..).find_map(|(&s, number)| (s == state).then_some(number)).unwrap_or(0)
}

/// What `found` stands for.
fn state<T: Copy>(states: &[T], found: i32, field: &'static str) -> Result<T, WireError> {
    usize::try_from(found)
        .ok()
        .and_then(|place| states.get(place).copied())
        .ok_or(WireError::UnknownValue { field, found })
}

/// What `found` stands for, in a field that may be left out.
fn optional<T: Copy>(
    states: &[T],
    found: Option<i32>,
    field: &'static str,
) -> Result<Option<T>, WireError> {
    found.map(|found| state(states, found, field)).transpose()
}
