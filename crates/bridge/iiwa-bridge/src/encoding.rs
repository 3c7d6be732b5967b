//! Message formats: JSON, and optionally CDR or Protobuf for joints.

use std::str::FromStr;

use prost::Message as _;
use serde::Serialize;

use iiwa_kin::Joints;

use crate::message::{Content, CycleSample, Message, Timestamp, VERSION};

/// Format of `joints` messages; all other messages are JSON.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum JointFormat {
    /// JSON, like all other messages.
    #[default]
    Json,
    /// `sensor_msgs/JointState` in CDR, little-endian, as in ROS 2; the frame is the robot name.
    Cdr,
    /// Protobuf: [`JointsProto`].
    Protobuf,
}

impl FromStr for JointFormat {
    type Err = ();

    /// Parses the name: `json`, `cdr` or `protobuf`.
    fn from_str(name: &str) -> Result<Self, ()> {
        match name {
            "json" => Ok(Self::Json),
            "cdr" => Ok(Self::Cdr),
            "protobuf" => Ok(Self::Protobuf),
            _ => Err(()),
        }
    }
}

/// A `joints` message in Protobuf:
///
/// ```proto
/// syntax = "proto3";
/// package iiwasim;
///
/// message Joints {
///   uint32 version = 1;
///   string robot = 2;
///   uint64 session = 3;
///   uint64 seq = 4;
///   uint64 at_us = 5;               // microseconds since 1970
///   double t_s = 6;                 // the controller's clock
///   repeated double joints_rad = 7; // A1 to A7
///   repeated double measured_nm = 8;
///   repeated double external_nm = 9;
/// }
/// ```
#[derive(Clone, PartialEq, prost::Message)]
pub struct JointsProto {
    /// Schema version.
    #[prost(uint32, tag = "1")]
    pub version: u32,
    /// Robot name.
    #[prost(string, tag = "2")]
    pub robot: String,
    /// Start time of the bridge session, as in JSON.
    #[prost(uint64, tag = "3")]
    pub session: u64,
    /// Sequence number, as in JSON.
    #[prost(uint64, tag = "4")]
    pub seq: u64,
    /// Time at which the bridge received the data, in microseconds since 1970.
    #[prost(uint64, tag = "5")]
    pub at_us: u64,
    /// Time stamp, in s.
    #[prost(double, tag = "6")]
    pub t_s: f64,
    /// Positions, in rad.
    #[prost(double, repeated, tag = "7")]
    pub joints_rad: Vec<f64>,
    /// Measured torques, in Nm.
    #[prost(double, repeated, tag = "8")]
    pub measured_nm: Vec<f64>,
    /// External torques, in Nm.
    #[prost(double, repeated, tag = "9")]
    pub external_nm: Vec<f64>,
}

/// CDR header, little-endian.
const CDR_HEAD: [u8; 4] = [0, 1, 0, 0];

impl JointFormat {
    /// Encodes a message.
    #[must_use]
    pub fn encode(self, message: &Message) -> Vec<u8> {
        match (&message.content, self) {
            (Content::Joints(sample), Self::Cdr) => cdr(message, sample),
            (Content::Joints(sample), Self::Protobuf) => protobuf(message, sample),
            _ => message.to_json().into_bytes(),
        }
    }

    /// Decodes a `joints` message in Protobuf; `None` for other bytes.
    #[must_use]
    pub fn decode_protobuf(bytes: &[u8]) -> Option<Message> {
        let joints = JointsProto::decode(bytes).ok()?;
        let seven = |numbers: &[f64]| Joints::try_from(numbers).ok();
        Some(Message {
            version: Some(joints.version).filter(|version| *version == VERSION)?,
            robot: joints.robot,
            session: joints.session,
            seq: joints.seq,
            at: Timestamp::from_micros(joints.at_us),
            content: Content::Joints(CycleSample {
                t_s: joints.t_s,
                joints_rad: seven(&joints.joints_rad)?,
                measured_nm: seven(&joints.measured_nm),
                external_nm: seven(&joints.external_nm),
            }),
        })
    }

    /// Returns true if bytes of [`encode`](Self::encode) are JSON.
    #[must_use]
    pub fn is_json(bytes: &[u8]) -> bool {
        bytes.first() == Some(&b'{')
    }
}

fn protobuf(message: &Message, sample: &CycleSample) -> Vec<u8> {
    let CycleSample { t_s, joints_rad, measured_nm, external_nm } = sample;
    JointsProto {
        version: message.version,
        robot: message.robot.clone(),
        session: message.session,
        seq: message.seq,
        at_us: message.at.micros(),
        t_s: *t_s,
        joints_rad: joints_rad.to_vec(),
        measured_nm: measured_nm.map(Vec::from).unwrap_or_default(),
        external_nm: external_nm.map(Vec::from).unwrap_or_default(),
    }
    .encode_to_vec()
}

fn cdr(message: &Message, sample: &CycleSample) -> Vec<u8> {
    #[derive(Serialize)]
    struct Time {
        sec: i32,
        nanosec: u32,
    }
    #[derive(Serialize)]
    struct Header<'a> {
        stamp: Time,
        frame_id: &'a str,
    }
    #[derive(Serialize)]
    struct JointState<'a> {
        header: Header<'a>,
        name: &'a [&'a str],
        position: &'a [f64],
        velocity: &'a [f64],
        effort: &'a [f64],
    }
    let micros = message.at.micros();
    let stamp = Time {
        sec: i32::try_from(micros / 1_000_000).unwrap_or(i32::MAX),
        nanosec: (micros % 1_000_000) as u32 * 1000,
    };
    let state = JointState {
        header: Header { stamp, frame_id: &message.robot },
        name: &["A1", "A2", "A3", "A4", "A5", "A6", "A7"],
        position: &sample.joints_rad,
        velocity: &[],
        effort: sample.measured_nm.as_ref().map_or(&[], <[f64; 7]>::as_slice),
    };
    let mut bytes = CDR_HEAD.to_vec();
    // Writing to memory does not fail.
    let _ = cdr_encoding::to_writer::<_, byteorder::LittleEndian, _>(&mut bytes, &state);
    bytes
}
