//! Wire format of FRI 1.14 to 1.16: protobuf (proto2), one message per datagram.

use std::time::Duration;

use iiwa_kin::Joints;
use prost::Message;

use crate::{
    error::WireError,
    message::{
        Command, CommandMode, ControlMode, Drive, Monitoring, OperationMode, Overlay, Quality,
        Safety, SessionState,
    },
};

/// Identifier of monitoring messages.
const MONITORING: u32 = 0x0024_5142;
/// Identifier of command messages.
const COMMAND: u32 = 0x0003_4001;

// The number on the wire is the index into the list.
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

// Every field is optional: prost would decode a missing required field as zero.

#[derive(Clone, PartialEq, Message)]
struct MonitoringMessage {
    #[prost(message, optional, tag = "1")]
    header: Option<FriHeader>,
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
    header: Option<FriHeader>,
    #[prost(message, optional, tag = "2")]
    data: Option<CommandData>,
}

#[derive(Clone, Copy, PartialEq, Message)]
struct FriHeader {
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
    // The controller's decoder accepts unpacked values only: one tag per value.
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
        header: Some(FriHeader::new(MONITORING, message.sequence, message.reflected)),
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
    for &state_number in &robot.drives {
        let next = state(DRIVES, state_number, "robotInfo.driveState")?;
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
    let header = Some(FriHeader::new(COMMAND, message.sequence, message.reflected));
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

impl FriHeader {
    const fn new(identifier: u32, sequence: u32, reflected: u32) -> Self {
        Self { identifier: Some(identifier), sequence: Some(sequence), reflected: Some(reflected) }
    }
}

impl TimeStamp {
    /// Creates a time stamp. Seconds have 32 bits on the wire, so they wrap around in 2106.
    #[expect(clippy::cast_possible_truncation, reason = "32 bits on the wire")]
    fn new(time: Duration) -> Self {
        Self { seconds: Some(time.as_secs() as u32), nanoseconds: Some(time.subsec_nanos()) }
    }

    fn duration(self) -> Result<Duration, WireError> {
        let seconds = required(self.seconds, "monitorData.timestamp.sec")?;
        let nanoseconds = required(self.nanoseconds, "monitorData.timestamp.nanosec")?;
        Ok(Duration::from_secs(seconds.into()) + Duration::from_nanos(nanoseconds.into()))
    }
}

/// Returns the sequence counters of a header: the sender's counter and the reflected one.
fn counters(header: Option<FriHeader>, expected: u32) -> Result<(u32, u32), WireError> {
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

/// Returns the number of `state` on the wire.
fn number<T: Copy + Eq>(states: &[T], state: T) -> i32 {
    states.iter().zip(0..).find_map(|(&s, number)| (s == state).then_some(number)).unwrap_or(0)
}

/// Returns the state with the number `found` on the wire.
fn state<T: Copy>(states: &[T], found: i32, field: &'static str) -> Result<T, WireError> {
    usize::try_from(found)
        .ok()
        .and_then(|index| states.get(index).copied())
        .ok_or(WireError::UnknownValue { field, found })
}

/// Returns the state of an optional field with the number `found` on the wire.
fn optional<T: Copy>(
    states: &[T],
    found: Option<i32>,
    field: &'static str,
) -> Result<Option<T>, WireError> {
    found.map(|found| state(states, found, field)).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINTS: Joints = [1.0, -2.0, 0.0, 0.5, 3.0, -0.25, 8.0];

    fn bytes(parts: &[&[u8]]) -> Vec<u8> {
        parts.concat()
    }

    /// Returns `JOINTS`, one tag per value, encoded by hand: tag 1 with 64 bits, then the double.
    fn unpacked() -> Vec<u8> {
        let mut out = Vec::new();
        for high in [0x3ff0_u16, 0xc000, 0x0000, 0x3fe0, 0x4008, 0xbfd0, 0x4020] {
            out.extend([0x09, 0, 0, 0, 0, 0, 0]);
            out.extend(high.to_le_bytes());
        }
        out
    }

    #[test]
    fn an_answer_is_these_bytes() {
        let command = Command { sequence: 5, reflected: 300, joints_rad: Some(JOINTS) };
        let expected = bytes(&[
            &[0x0a, 9, 0x08, 0x81, 0x80, 0x0d, 0x10, 5, 0x18, 0xac, 0x02],
            &[0x12, 65, 0x0a, 63],
            &unpacked(),
        ]);
        let mut out = Vec::new();
        encode_command(&command, &mut out);
        assert_eq!(out, expected);
        assert_eq!(decode_command(&expected).unwrap(), command);

        let header = Command { joints_rad: None, ..command };
        assert_eq!(decode_command(&expected[..11]).unwrap(), header);
        let end_of_message = bytes(&[&expected[..11], &[0x7a, 0]]);
        assert_eq!(decode_command(&end_of_message).unwrap(), header);
    }

    #[test]
    fn a_monitoring_message_is_these_bytes() {
        let message = Monitoring {
            sequence: 1,
            reflected: u32::MAX,
            session: SessionState::CommandingActive,
            quality: Quality::Excellent,
            send_period_ms: 5,
            receive_multiplier: 2,
            safety: Some(Safety::Stop2),
            operation_mode: Some(OperationMode::Automatic),
            drive: Some(Drive::Transitioning),
            control_mode: Some(ControlMode::JointImpedance),
            external_torque_nm: Some(JOINTS),
            ipo_rad: Some(JOINTS),
            command_mode: Some(CommandMode::Torque),
            overlay: Some(Overlay::Joint),
            tracking_performance: Some(0.5),
            time: Some(Duration::new(7, 128)),
            ..Monitoring::default()
        };
        let expected = bytes(&[
            &[0x0a, 13, 0x08, 0xc2, 0xa2, 0x91, 0x01, 0x10, 1],
            &[0x18, 0xff, 0xff, 0xff, 0xff, 0x0f],
            &[0x12, 22, 0x08, 7, 0x10, 3],
            &[0x28, 1, 0x28, 1, 0x28, 1, 0x28, 1, 0x28, 1, 0x28, 1, 0x28, 1, 0x30, 2, 0x38, 2],
            &[0x1a, 72, 0x2a, 63],
            &unpacked(),
            &[0x7a, 5, 0x08, 7, 0x10, 0x80, 0x01],
            &[0x22, 8, 0x08, 4, 0x10, 3, 0x18, 5, 0x20, 2],
            &[0x2a, 78, 0x0a, 63],
            &unpacked(),
            &[0x50, 3, 0x58, 1, 0x61, 0, 0, 0, 0, 0, 0, 0xe0, 0x3f],
        ]);
        let mut out = Vec::new();
        encode_monitoring(&message, &mut out);
        assert_eq!(out, expected);
        assert_eq!(decode_monitoring(&expected).unwrap(), message);
    }

    #[test]
    fn the_smallest_message_is_a_header_and_a_connection() {
        let smallest = [0x0a, 9, 0x08, 0xc2, 0xa2, 0x91, 0x01, 0x10, 0, 0x18, 0];
        let connection = [0x22, 4, 0x08, 0, 0x10, 0];
        let message = decode_monitoring(&bytes(&[&smallest, &connection])).unwrap();
        assert_eq!(message, Monitoring::default());
        assert_eq!(
            decode_monitoring(&smallest),
            Err(WireError::Missing { field: "connectionInfo" })
        );
    }

    #[test]
    fn packed_values_are_accepted() {
        let packed: Vec<u8> = JOINTS.iter().flat_map(|q| q.to_le_bytes()).collect();
        let answer = bytes(&[
            &[0x0a, 8, 0x08, 0x81, 0x80, 0x0d, 0x10, 5, 0x18, 0],
            &[0x12, 60, 0x0a, 58, 0x0a, 56],
            &packed,
        ]);
        assert_eq!(decode_command(&answer).unwrap().joints_rad, Some(JOINTS));
    }

    /// Decodes a command with `data` after its header.
    fn command(data: &CommandData) -> Result<Command, WireError> {
        let header = Some(FriHeader::new(COMMAND, 0, 0));
        decode_command(&CommandMessage { header, data: Some(data.clone()) }.encode_to_vec())
    }

    #[test]
    fn joints_are_seven_finite_numbers() {
        let field = "commandData.jointPosition";
        for session in [0, 6, 8, 14, 150] {
            let joints = Some(JointValues { values: vec![1.0; session] });
            let error = command(&CommandData { joints }).unwrap_err();
            assert_eq!(error, WireError::JointCount { field, found: session });
        }
        for q in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let joints = Some(JointValues { values: vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, q] });
            let error = command(&CommandData { joints }).unwrap_err();
            assert_eq!(error, WireError::NotFinite { field });
        }
        assert_eq!(command(&CommandData { joints: None }).unwrap(), Command::default());
    }

    /// Returns the error of a valid message after `change`.
    fn error(change: impl Fn(&mut MonitoringMessage)) -> String {
        let mut message = MonitoringMessage {
            header: Some(FriHeader::new(MONITORING, 1, 2)),
            connection: Some(ConnectionInfo {
                session: Some(1),
                quality: Some(1),
                ..ConnectionInfo::default()
            }),
            robot: Some(RobotInfo::default()),
            monitor: Some(MonitorData::default()),
            ipo: Some(IpoData::default()),
        };
        assert!(decode_monitoring(&message.encode_to_vec()).is_ok());
        change(&mut message);
        decode_monitoring(&message.encode_to_vec()).unwrap_err().to_string()
    }

    #[test]
    fn errors_name_the_field() {
        let header = |identifier, sequence, reflected| {
            error(|message| message.header = Some(FriHeader { identifier, sequence, reflected }))
        };
        assert_eq!(error(|message| message.header = None), "`header` is missing");
        assert_eq!(header(None, Some(1), Some(1)), "`header.messageIdentifier` is missing");
        assert_eq!(header(Some(MONITORING), None, Some(1)), "`header.sequenceCounter` is missing");
        assert_eq!(
            header(Some(MONITORING), Some(1), None),
            "`header.reflectedSequenceCounter` is missing"
        );
        assert_eq!(
            header(Some(COMMAND), Some(1), Some(1)),
            "message identifier 0x34001, expected 0x245142"
        );

        let connection = |session, quality, receive_multiplier| {
            let connection =
                ConnectionInfo { session, quality, receive_multiplier, send_period_ms: None };
            error(|message| message.connection = Some(connection))
        };
        assert_eq!(connection(None, Some(1), None), "`connectionInfo.sessionState` is missing");
        assert_eq!(connection(Some(1), None, None), "`connectionInfo.quality` is missing");
        assert_eq!(
            connection(Some(5), Some(1), None),
            "unknown value 5 in `connectionInfo.sessionState`"
        );
        assert_eq!(
            connection(Some(1), Some(-1), None),
            "unknown value -1 in `connectionInfo.quality`"
        );
        assert_eq!(
            connection(Some(1), Some(1), Some(0)),
            "`connectionInfo.receiveMultiplier` is 0, expected at least 1"
        );

        let robot = |robot: RobotInfo| error(|message| message.robot = Some(robot.clone()));
        assert_eq!(
            robot(RobotInfo { safety: Some(4), ..RobotInfo::default() }),
            "unknown value 4 in `robotInfo.safetyState`"
        );
        assert_eq!(
            robot(RobotInfo { drives: vec![2, 3], ..RobotInfo::default() }),
            "unknown value 3 in `robotInfo.driveState`"
        );
        assert_eq!(
            error(|message| {
                message.ipo =
                    Some(IpoData { tracking_performance: Some(f64::NAN), ..IpoData::default() });
            }),
            "`ipoData.trackingPerformance` contains a value that is not finite"
        );
        assert_eq!(
            error(|message| {
                let time = Some(TimeStamp { seconds: Some(1), nanoseconds: None });
                message.monitor = Some(MonitorData { time, ..MonitorData::default() });
            }),
            "`monitorData.timestamp.nanosec` is missing"
        );
    }

    #[test]
    fn drives_that_differ_are_reported_as_the_one_furthest_from_active() {
        let stamp = TimeStamp { seconds: Some(u32::MAX), nanoseconds: Some(u32::MAX) };
        let message = MonitoringMessage {
            header: Some(FriHeader::new(MONITORING, 1, 2)),
            connection: Some(ConnectionInfo {
                session: Some(1),
                quality: Some(1),
                ..ConnectionInfo::default()
            }),
            robot: Some(RobotInfo { drives: vec![2, 1, 2], ..RobotInfo::default() }),
            monitor: Some(MonitorData { time: Some(stamp), ..MonitorData::default() }),
            ipo: None,
        };
        let message = decode_monitoring(&message.encode_to_vec()).unwrap();
        assert_eq!(message.drive, Some(Drive::Transitioning));
        assert_eq!(message.time, Some(Duration::new(u64::from(u32::MAX) + 4, 294_967_295)));
    }
}
