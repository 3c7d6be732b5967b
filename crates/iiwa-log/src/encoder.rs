//! Messages as bytes.

use std::borrow::Cow;
use std::time::Duration;

use serde::{Serialize, Serializer};

use crate::error::WriteError;
use crate::ros::{
    Header, JointState, Joints, MotionMessage, Names, PoseStamped, Text, Time, TransformStamped,
};
use crate::{Motion, Topic, cdr};

/// The pose of one coordinate frame in another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<'a> {
    /// The frame that the pose is given in.
    pub parent: &'a str,
    /// The frame whose pose it is.
    pub child: &'a str,
    /// The origin of `child` in `parent`, m.
    pub translation_m: [f64; 3],
    /// The rotation from `child` to `parent`, unit quaternion x, y, z, w.
    pub rotation_xyzw: [f64; 4],
}

/// Encodes messages one by one, as [`Topic`] says: what a [`Writer`](crate::Writer) puts into a file,
/// for those who send it elsewhere.
///
/// Every method takes the time `t` since the epoch and gives the bytes of one message, which the next
/// call overwrites. Nothing is held against the messages before: that times increase is for the
/// caller to see to.
///
/// ```
/// use std::time::Duration;
///
/// use iiwa_log::Encoder;
///
/// # fn main() -> Result<(), iiwa_log::WriteError> {
/// let mut encoder = Encoder::new(Duration::ZERO)?;
/// let now = Duration::from_secs(1_700_000_000);
/// let message = encoder.joint_state(now, &[0.0; 7], &[0.0; 7])?;
/// // CDR, little-endian, and the seconds of the stamp.
/// assert_eq!(message[..4], [0, 1, 0, 0]);
/// assert_eq!(message[4..8], 1_700_000_000_u32.to_le_bytes());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Encoder {
    epoch: Duration,
    buffer: Vec<u8>,
}

impl Encoder {
    /// For messages with times since `epoch`, which is the time since 1970-01-01T00:00:00Z.
    ///
    /// # Errors
    ///
    /// [`WriteError::EpochOutOfRange`] for an epoch past 2038.
    pub fn new(epoch: Duration) -> Result<Self, WriteError> {
        Time::from_duration(epoch).ok_or(WriteError::EpochOutOfRange { epoch })?;
        Ok(Self { epoch, buffer: Vec::new() })
    }

    /// Positions (rad) and velocities (rad/s) of the seven joints, for `/joint_states`.
    ///
    /// # Errors
    ///
    /// [`WriteError::StampOutOfRange`] past 2038.
    pub fn joint_state(
        &mut self,
        t: Duration,
        positions: &[f64; 7],
        velocities: &[f64; 7],
    ) -> Result<&[u8], WriteError> {
        let topic = Topic::JointStates;
        let message = JointState {
            header: self.header(topic, t, "")?,
            name: Names::Iiwa,
            position: Joints::from(*positions),
            velocity: Joints::from(*velocities),
            effort: Joints::EMPTY,
        };
        self.encode(topic, &message)
    }

    /// The poses of all `frames` in one message, for `/tf`.
    ///
    /// # Errors
    ///
    /// As [`joint_state`](Self::joint_state).
    pub fn transforms(&mut self, t: Duration, frames: &[Frame<'_>]) -> Result<&[u8], WriteError> {
        let topic = Topic::Tf;
        let message = Transforms { stamp: self.stamp(topic, t)?, frames };
        self.encode(topic, &message)
    }

    /// The pose of the flange in `frame_id`, for `/tcp_pose`: position in m, rotation as a unit
    /// quaternion x, y, z, w.
    ///
    /// # Errors
    ///
    /// As [`joint_state`](Self::joint_state).
    pub fn tcp_pose(
        &mut self,
        t: Duration,
        frame_id: &str,
        position_m: [f64; 3],
        rotation_xyzw: [f64; 4],
    ) -> Result<&[u8], WriteError> {
        let topic = Topic::TcpPose;
        let header = self.header(topic, t, frame_id)?;
        let message = PoseStamped { header, position: position_m, orientation: rotation_xyzw };
        self.encode(topic, &message)
    }

    /// The robot's URDF, for `/robot_description`, which has no stamp.
    ///
    /// # Errors
    ///
    /// None that a caller can cause: [`WriteError::Encode`] if the encoder gives up.
    pub fn robot_description(&mut self, urdf: &str) -> Result<&[u8], WriteError> {
        let message = Text { data: urdf.into() };
        self.encode(Topic::RobotDescription, &message)
    }

    /// The start of a piece of the path, for `/motion`.
    ///
    /// # Errors
    ///
    /// [`WriteError::NoSuchJoint`] for a limiting joint other than 1 to 7, and as
    /// [`joint_state`](Self::joint_state).
    pub fn motion(&mut self, t: Duration, motion: &Motion<'_>) -> Result<&[u8], WriteError> {
        let topic = Topic::Motion;
        if let Some(joint) = motion.limiting_joint.filter(|joint| !(1..=7).contains(joint)) {
            return Err(WriteError::NoSuchJoint { joint, t });
        }
        let message = MotionMessage {
            header: self.header(topic, t, "")?,
            index: motion.index,
            kind: Cow::Borrowed(&motion.kind),
            limiting_joint: motion.limiting_joint.map_or(0, u32::from),
            limiting_kind: Cow::Borrowed(&motion.limiting_kind),
        };
        self.encode(topic, &message)
    }

    /// The instant of `t` as a message carries it.
    pub(crate) fn stamp(&self, topic: Topic, t: Duration) -> Result<Time, WriteError> {
        self.epoch.checked_add(t).and_then(Time::from_duration).ok_or(WriteError::StampOutOfRange {
            topic,
            t,
            epoch: self.epoch,
        })
    }

    fn header<'a>(
        &self,
        topic: Topic,
        t: Duration,
        frame_id: &'a str,
    ) -> Result<Header<'a>, WriteError> {
        Ok(Header { stamp: self.stamp(topic, t)?, frame_id: frame_id.into() })
    }

    fn encode<T: Serialize>(&mut self, topic: Topic, message: &T) -> Result<&[u8], WriteError> {
        cdr::encode(&mut self.buffer, message)
            .map_err(|source| WriteError::Encode { topic, source })?;
        Ok(&self.buffer)
    }
}

/// `tf2_msgs/msg/TFMessage`, made of borrowed frames.
struct Transforms<'a> {
    stamp: Time,
    frames: &'a [Frame<'a>],
}

impl Serialize for Transforms<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.frames.iter().map(|frame| TransformStamped {
            header: Header { stamp: self.stamp, frame_id: frame.parent.into() },
            child_frame_id: frame.child.into(),
            translation: frame.translation_m,
            rotation: frame.rotation_xyzw,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_does_not_depend_on_the_one_before() {
        let mut encoder = Encoder::new(Duration::from_secs(7)).unwrap();
        let t = Duration::from_millis(1500);
        let first = encoder.joint_state(t, &[0.5; 7], &[0.25; 7]).unwrap().to_vec();
        let urdf = "<robot/>".repeat(1000);
        assert!(encoder.robot_description(&urdf).unwrap().len() > urdf.len());
        assert_eq!(encoder.joint_state(t, &[0.5; 7], &[0.25; 7]).unwrap(), first);

        let decoded: JointState<'_> = cdr::decode(&first).unwrap();
        assert_eq!(decoded.header.stamp, Time { sec: 8, nanosec: 500_000_000 });
        assert_eq!(decoded.position, Joints::from([0.5; 7]));
        assert_eq!(decoded.velocity, Joints::from([0.25; 7]));
    }

    #[test]
    fn a_time_past_2038_is_refused() {
        let (last, second) = (Duration::from_secs(i32::MAX as u64), Duration::from_secs(1));
        let error = Encoder::new(last + second).unwrap_err();
        assert!(matches!(error, WriteError::EpochOutOfRange { .. }), "{error}");
        let mut encoder = Encoder::new(last).unwrap();
        assert!(encoder.transforms(Duration::ZERO, &[]).is_ok());
        let error = encoder.transforms(second, &[]).unwrap_err();
        assert!(matches!(error, WriteError::StampOutOfRange { .. }), "{error}");
    }
}
