//! Message encoding.

use std::borrow::Cow;
use std::iter;
use std::time::Duration;

use iiwa_kin::RosNames;
use serde::Serialize;

use crate::error::WriteError;
use crate::ros::{
    DiagnosticArray, Header, JointArray, JointNames, JointState, MotionMessage, PoseStamped, Text,
    Time, TransformStamped,
};
use crate::template::{Template, Word, stamp_word};
use crate::{Diagnostic, MotionEntry, Topic, cdr};

/// Pose of one coordinate frame in another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FramePose<'a> {
    /// Frame in which the pose is expressed.
    pub parent: &'a str,
    /// Frame whose pose is given.
    pub child: &'a str,
    /// Origin of `child` in `parent`, m.
    pub translation_m: [f64; 3],
    /// Rotation from `child` to `parent`, unit quaternion x, y, z, w.
    pub rotation_xyzw: [f64; 4],
}

/// Encodes single messages as [`Topic`] specifies: the bytes that a [`Writer`](crate::Writer) puts
/// into a file, for other transports.
///
/// Every method takes the time `t` since the epoch and returns the bytes of one message, which the
/// next call overwrites. The encoder does not compare messages with earlier ones: the caller
/// ensures that times increase.
///
/// ```
/// use std::time::Duration;
///
/// use iiwa_log::Encoder;
///
/// # fn main() -> Result<(), iiwa_log::WriteError> {
/// let mut encoder = Encoder::new(Duration::ZERO)?;
/// let now = Duration::from_secs(1_700_000_000);
/// let message = encoder.joint_state(now, &[0.0; 7], &[0.0; 7], None)?;
/// // CDR, little-endian, and the seconds of the stamp.
/// assert_eq!(message[..4], [0, 1, 0, 0]);
/// assert_eq!(message[4..8], 1_700_000_000_u32.to_le_bytes());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Encoder {
    epoch: Duration,
    /// Prefix of the joint names.
    joint_stem: String,
    buffer: Vec<u8>,
    words: Vec<Word>,
    /// Templates of the last messages on frequently written topics.
    joint_state: Option<Template>,
    joint_effort: Option<Template>,
    transforms: Option<Template>,
    chain: Option<Template>,
    tcp_pose: Option<Template>,
    flange_pose: Option<Template>,
}

impl Encoder {
    /// Creates an encoder for messages with times since `epoch`, which is the time since
    /// 1970-01-01T00:00:00Z.
    ///
    /// # Errors
    ///
    /// [`WriteError::EpochOutOfRange`] for an epoch past 2038.
    pub fn new(epoch: Duration) -> Result<Self, WriteError> {
        Self::with_names(epoch, &RosNames::default())
    }

    /// Creates an encoder with other joint names. Link names are given with each message.
    ///
    /// # Errors
    ///
    /// See [`new`](Self::new).
    pub fn with_names(epoch: Duration, names: &RosNames) -> Result<Self, WriteError> {
        Time::from_duration(epoch).ok_or(WriteError::EpochOutOfRange { epoch })?;
        Ok(Self {
            epoch,
            joint_stem: names.joint_stem(),
            buffer: Vec::new(),
            words: Vec::new(),
            joint_state: None,
            joint_effort: None,
            transforms: None,
            chain: None,
            tcp_pose: None,
            flange_pose: None,
        })
    }

    /// Encodes positions (rad) and velocities (rad/s) of the seven joints, and torques (Nm) as
    /// `effort` if given, for `/joint_states`.
    ///
    /// # Errors
    ///
    /// [`WriteError::StampOutOfRange`] past 2038.
    pub fn joint_state(
        &mut self,
        t: Duration,
        positions: &[f64; 7],
        velocities: &[f64; 7],
        torques: Option<&[f64; 7]>,
    ) -> Result<&[u8], WriteError> {
        let topic = Topic::JointStates;
        let stamp = self.stamp(topic, t)?;
        let template = match torques {
            Some(_) => &mut self.joint_effort,
            None => &mut self.joint_state,
        };
        let template = up_to_date(template, topic, iter::empty, |buffer, stamp, value| {
            let message = JointState {
                header: Header { stamp, frame_id: "".into() },
                name: JointNames::Of(self.joint_stem.as_str().into()),
                position: JointArray::from([value; 7]),
                velocity: JointArray::from([value; 7]),
                effort: torques.map_or(JointArray::EMPTY, |_| JointArray::from([value; 7])),
            };
            cdr::encode(buffer, &message)
        })?;
        self.words.clear();
        self.words.push(stamp_word(stamp));
        for numbers in [positions, velocities].into_iter().chain(torques) {
            self.words.extend(numbers.map(f64::to_le_bytes));
        }
        Ok(template.fill(&self.words))
    }

    /// Encodes the poses of all `frames` in one message, for `/tf`.
    ///
    /// # Errors
    ///
    /// See [`joint_state`](Self::joint_state).
    pub fn transforms(
        &mut self,
        t: Duration,
        frames: &[FramePose<'_>],
    ) -> Result<&[u8], WriteError> {
        let topic = Topic::Tf;
        let stamp = self.stamp(topic, t)?;
        let names = || frames.iter().flat_map(|frame| [frame.parent, frame.child]);
        let template = up_to_date(&mut self.transforms, topic, names, |buffer, stamp, value| {
            encode_transforms(buffer, stamp, frames, value)
        })?;
        Ok(template.fill(transform_words(&mut self.words, stamp, frames)))
    }

    /// Encodes the poses of `frames` whose names never change: the names are not compared with
    /// those of the first call.
    pub(crate) fn chain(
        &mut self,
        t: Duration,
        frames: &[FramePose<'_>],
    ) -> Result<&[u8], WriteError> {
        let topic = Topic::Tf;
        let stamp = self.stamp(topic, t)?;
        let template = up_to_date(&mut self.chain, topic, iter::empty, |buffer, stamp, value| {
            encode_transforms(buffer, stamp, frames, value)
        })?;
        Ok(template.fill(transform_words(&mut self.words, stamp, frames)))
    }

    /// Encodes the TCP pose in `frame_id`, for `/tcp_pose`: position in m, rotation as a unit
    /// quaternion x, y, z, w.
    ///
    /// # Errors
    ///
    /// See [`joint_state`](Self::joint_state).
    pub fn tcp_pose(
        &mut self,
        t: Duration,
        frame_id: &str,
        position_m: [f64; 3],
        rotation_xyzw: [f64; 4],
    ) -> Result<&[u8], WriteError> {
        self.pose(Topic::TcpPose, t, frame_id, position_m, rotation_xyzw)
    }

    /// Encodes the flange pose in `frame_id`, for `/flange_pose`, if the flange is not the TCP.
    ///
    /// # Errors
    ///
    /// See [`joint_state`](Self::joint_state).
    pub fn flange_pose(
        &mut self,
        t: Duration,
        frame_id: &str,
        position_m: [f64; 3],
        rotation_xyzw: [f64; 4],
    ) -> Result<&[u8], WriteError> {
        self.pose(Topic::FlangePose, t, frame_id, position_m, rotation_xyzw)
    }

    fn pose(
        &mut self,
        topic: Topic,
        t: Duration,
        frame_id: &str,
        position_m: [f64; 3],
        rotation_xyzw: [f64; 4],
    ) -> Result<&[u8], WriteError> {
        let stamp = self.stamp(topic, t)?;
        let template = match topic {
            Topic::FlangePose => &mut self.flange_pose,
            _ => &mut self.tcp_pose,
        };
        let template = up_to_date(
            template,
            topic,
            || iter::once(frame_id),
            |buffer, stamp, value| {
                let header = Header { stamp, frame_id: frame_id.into() };
                let message = PoseStamped { header, position: [value; 3], orientation: [value; 4] };
                cdr::encode(buffer, &message)
            },
        )?;
        self.words.clear();
        self.words.push(stamp_word(stamp));
        self.words.extend(position_m.map(f64::to_le_bytes));
        self.words.extend(rotation_xyzw.map(f64::to_le_bytes));
        Ok(template.fill(&self.words))
    }

    /// Encodes the robot's URDF, for `/robot_description`, which has no stamp.
    ///
    /// # Errors
    ///
    /// [`WriteError::Encode`] if the encoder fails, which no input causes.
    pub fn robot_description(&mut self, urdf: &str) -> Result<&[u8], WriteError> {
        let message = Text { data: urdf.into() };
        self.encode(Topic::RobotDescription, &message)
    }

    /// Encodes the status of machine components, for `/diagnostics`.
    ///
    /// # Errors
    ///
    /// See [`joint_state`](Self::joint_state).
    pub fn diagnostics(
        &mut self,
        t: Duration,
        parts: &[Diagnostic<'_>],
    ) -> Result<&[u8], WriteError> {
        let topic = Topic::Diagnostics;
        let header = self.header(topic, t, "")?;
        self.encode(topic, &DiagnosticArray { header, status: parts })
    }

    /// Encodes the start of a path piece, for `/motion`.
    ///
    /// # Errors
    ///
    /// [`WriteError::NoSuchJoint`] for a limiting joint other than 1 to 7, and the errors of
    /// [`joint_state`](Self::joint_state).
    pub fn motion(&mut self, t: Duration, motion: &MotionEntry<'_>) -> Result<&[u8], WriteError> {
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
            name: Cow::Borrowed(motion.name.as_deref().unwrap_or_default()),
            group: Cow::Borrowed(motion.group.as_deref().unwrap_or_default()),
        };
        self.encode(topic, &message)
    }

    /// Prefix of the joint names.
    pub(crate) fn joint_stem(&self) -> &str {
        &self.joint_stem
    }

    /// Stamp of `t` as in messages.
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

/// Encodes a `tf2_msgs/msg/TFMessage` with the same stamp and the same double everywhere.
fn encode_transforms(
    buffer: &mut Vec<u8>,
    stamp: Time,
    frames: &[FramePose<'_>],
    value: f64,
) -> Result<(), cdr_encoding::Error> {
    let transform = |frame: &FramePose<'_>| TransformStamped {
        header: Header { stamp, frame_id: frame.parent.to_owned().into() },
        child_frame_id: frame.child.to_owned().into(),
        translation: [value; 3],
        rotation: [value; 4],
    };
    cdr::encode(buffer, &frames.iter().map(transform).collect::<Vec<_>>())
}

/// Returns the stamps and doubles of a `tf2_msgs/msg/TFMessage`.
fn transform_words<'a>(
    words: &'a mut Vec<Word>,
    stamp: Time,
    frames: &[FramePose<'_>],
) -> &'a [Word] {
    words.clear();
    for frame in frames {
        words.push(stamp_word(stamp));
        words.extend(frame.translation_m.map(f64::to_le_bytes));
        words.extend(frame.rotation_xyzw.map(f64::to_le_bytes));
    }
    words
}

/// Returns the template of messages with these names: the last template if the names match,
/// otherwise a new one.
fn up_to_date<'a, 'n, N: Iterator<Item = &'n str>>(
    template: &'a mut Option<Template>,
    topic: Topic,
    names: impl Fn() -> N,
    encode: impl Fn(&mut Vec<u8>, Time, f64) -> Result<(), cdr_encoding::Error>,
) -> Result<&'a mut Template, WriteError> {
    let last = template.take().filter(|last| last.has(names()));
    let next = match last {
        Some(last) => last,
        None => {
            Template::new(names(), encode).map_err(|source| WriteError::Encode { topic, source })?
        }
    };
    Ok(template.insert(next))
}

#[cfg(test)]
mod tests {
    use iiwa_kin::RosStack;

    use super::*;

    #[test]
    fn a_message_does_not_depend_on_the_one_before() {
        let mut encoder = Encoder::new(Duration::from_secs(7)).unwrap();
        let t = Duration::from_millis(1500);
        let first = encoder.joint_state(t, &[0.5; 7], &[0.25; 7], None).unwrap().to_vec();
        let urdf = "<robot/>".repeat(1000);
        assert!(encoder.robot_description(&urdf).unwrap().len() > urdf.len());
        assert_eq!(encoder.joint_state(t, &[0.5; 7], &[0.25; 7], None).unwrap(), first);

        let decoded: JointState<'_> = cdr::decode(&first).unwrap();
        assert_eq!(decoded.header.stamp, Time { sec: 8, nanosec: 500_000_000 });
        assert_eq!(decoded.position, JointArray::from([0.5; 7]));
        assert_eq!(decoded.velocity, JointArray::from([0.25; 7]));
    }

    #[test]
    fn messages_equal_those_of_a_serializer() {
        let names = RosNames::new(RosStack::LbrFriRos2Stack, None);
        let mut encoder = Encoder::with_names(Duration::from_secs(7), &names).unwrap();
        let stamp = |t: Duration| Time::from_duration(Duration::from_secs(7) + t).unwrap();
        let value = |k: usize| 0.1 + k as f64;
        let shifted = |t: Duration, k: usize| value(k) + t.as_secs_f64();
        // Different names in between would reveal remains of an earlier message.
        let chains: [&[&str]; 4] =
            [&["a", "bc", "def"], &["world", "a"], &["a", "bc", "def"], &["a"]];
        for (tick, chain) in chains.into_iter().enumerate() {
            let t = Duration::from_millis(1234 * tick as u64);
            let numbers: [f64; 7] = std::array::from_fn(|k| shifted(t, k));
            let (position, rotation) = ([numbers[0]; 3], [numbers[1], -0.0, numbers[3], f64::MIN]);
            let header = |frame_id| Header { stamp: stamp(t), frame_id: Cow::Borrowed(frame_id) };
            let links = || chain.windows(2).enumerate();

            let frames: Vec<_> = links()
                .map(|(k, pair)| FramePose {
                    parent: pair[0],
                    child: pair[1],
                    translation_m: [shifted(t, k); 3],
                    rotation_xyzw: rotation,
                })
                .collect();
            let transforms: Vec<_> = links()
                .map(|(k, pair)| TransformStamped {
                    header: header(pair[0]),
                    child_frame_id: pair[1].into(),
                    translation: [shifted(t, k); 3],
                    rotation,
                })
                .collect();
            assert_eq!(encoder.transforms(t, &frames).unwrap(), encoded(&transforms));
            if chain == chains[0] {
                assert_eq!(encoder.chain(t, &frames).unwrap(), encoded(&transforms));
            }

            let pose = PoseStamped { header: header(chain[0]), position, orientation: rotation };
            let message = encoder.tcp_pose(t, chain[0], position, rotation).unwrap();
            assert_eq!(message, encoded(&pose));

            let state = JointState {
                header: header(""),
                name: JointNames::Of(names.joint_stem().into()),
                position: numbers.into(),
                velocity: [-numbers[0]; 7].into(),
                effort: JointArray::EMPTY,
            };
            let message = encoder.joint_state(t, &numbers, &[-numbers[0]; 7], None).unwrap();
            assert_eq!(message, encoded(&state));
        }
    }

    fn encoded(message: &impl Serialize) -> Vec<u8> {
        let mut bytes = Vec::new();
        cdr::encode(&mut bytes, message).unwrap();
        bytes
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
