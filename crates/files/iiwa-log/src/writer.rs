//! Writing a recording.

use std::collections::BTreeMap;
use std::io::Write;
use std::time::Duration;

use iiwa_kin::RosNames;
use mcap::records::AttachmentHeader;

use crate::chunk::Chunk;
use crate::container::Container;
use crate::error::WriteError;
use crate::ros::Time;
use crate::tail::Index;
use crate::{Diagnostic, Encoder, FramePose, MotionEntry, Topic, TrajectoryMessage};

/// 2020-01-01T00:00:00Z as the time since 1970-01-01T00:00:00Z (Unix time 1 577 836 800 s).
///
/// The instant is fixed, so that the same program gives the same bytes, and late enough for viewers
/// that interpret early stamps as durations.
pub const DEFAULT_EPOCH: Duration = Duration::from_secs(1_577_836_800);

/// Options of a recording file.
#[derive(Clone, Debug)]
pub struct Config {
    /// Instant of `t` = 0, as the time since 1970-01-01T00:00:00Z.
    pub epoch: Duration,
    /// Name of the writing program in the file header.
    pub library: String,
    /// Length of a chunk before compression, in bytes; a longer message is a chunk of its own. A
    /// short chunk fits into the processor's cache with all that is needed to compress it; long
    /// chunks make a short index.
    pub chunk_bytes: usize,
    /// Names of joints and links.
    pub names: RosNames,
}

impl Default for Config {
    /// Returns [`DEFAULT_EPOCH`], this crate's name and version, chunks of 1 MiB, and the names of
    /// `iiwa_stack`.
    fn default() -> Self {
        Self {
            epoch: DEFAULT_EPOCH,
            library: concat!(env!("CARGO_PKG_NAME"), "/", env!("CARGO_PKG_VERSION")).to_owned(),
            chunk_bytes: 1024 * 1024,
            names: RosNames::default(),
        }
    }
}

/// Writes a recording into a stream, in one pass.
///
/// Every method accepts the time `t` since the start of the motion and stamps its message with
/// [`Config::epoch`] + `t`, as header stamp, log time and publish time alike. Times must increase
/// within a topic; across topics their order is free, but viewers are fastest if all messages are
/// in the order of time.
///
/// Memory use stays at a few megabytes: only the index grows, by some 200 bytes per chunk.
///
/// The bytes depend on the calls and on [`Config`] alone. Call [`finish`](Self::finish): a writer
/// that is dropped leaves a file that is cut off.
pub struct Writer<W: Write> {
    encoder: Encoder,
    file: File<W>,
}

/// Container, apart from the encoder that lends it the bytes of a message.
struct File<W: Write> {
    container: Container<W>,
    epoch: Duration,
    epoch_ns: u64,
    channels: [TopicState; Topic::ALL.len()],
}

/// State of a topic.
#[derive(Clone, Copy, Debug, Default)]
struct TopicState {
    open: bool,
    sequence: u32,
    last: Option<Duration>,
}

impl<W: Write> std::fmt::Debug for Writer<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Writer")
            .field("epoch", &self.file.epoch)
            .field("channels", &self.file.channels)
            .finish_non_exhaustive()
    }
}

impl<W: Write> Writer<W> {
    /// Begins a recording in an empty stream.
    ///
    /// # Errors
    ///
    /// [`WriteError::EpochOutOfRange`] for an epoch past 2038, [`WriteError::Mcap`] if the stream
    /// fails.
    pub fn new(stream: W, config: Config) -> Result<Self, WriteError> {
        let Config { epoch, library, chunk_bytes, names } = config;
        let encoder = Encoder::with_names(epoch, &names)?;
        let epoch_ns =
            u64::try_from(epoch.as_nanos()).map_err(|_| WriteError::EpochOutOfRange { epoch })?;
        let container = Container::new(stream, library, chunk_bytes)?;
        let channels = [TopicState::default(); Topic::ALL.len()];
        Ok(Self { encoder, file: File { container, epoch, epoch_ns, channels } })
    }

    /// Writes positions (rad) and velocities (rad/s) of the seven joints, and torques (Nm) as
    /// `effort` if given, to `/joint_states`.
    ///
    /// # Errors
    ///
    /// [`WriteError::NotIncreasing`], [`WriteError::StampOutOfRange`] or [`WriteError::Mcap`].
    pub fn joint_state(
        &mut self,
        t: Duration,
        positions: &[f64; 7],
        velocities: &[f64; 7],
        torques: Option<&[f64; 7]>,
    ) -> Result<(), WriteError> {
        let message = self.encoder.joint_state(t, positions, velocities, torques)?;
        self.file.write(Topic::JointStates, t, message)
    }

    /// Writes the status of machine components to `/diagnostics`.
    ///
    /// # Errors
    ///
    /// See [`joint_state`](Self::joint_state).
    pub fn diagnostics(&mut self, t: Duration, parts: &[Diagnostic<'_>]) -> Result<(), WriteError> {
        self.file.write(Topic::Diagnostics, t, self.encoder.diagnostics(t, parts)?)
    }

    /// Writes the poses of all `frames` as one message to `/tf`.
    ///
    /// # Errors
    ///
    /// See [`joint_state`](Self::joint_state).
    pub fn transforms(&mut self, t: Duration, frames: &[FramePose<'_>]) -> Result<(), WriteError> {
        self.file.write(Topic::Tf, t, self.encoder.transforms(t, frames)?)
    }

    /// Writes the poses of `frames`, which have the same names as in the first call.
    pub(crate) fn chain(
        &mut self,
        t: Duration,
        frames: &[FramePose<'_>],
    ) -> Result<(), WriteError> {
        self.file.write(Topic::Tf, t, self.encoder.chain(t, frames)?)
    }

    /// Writes the TCP pose in `frame_id` to `/tcp_pose`: position in m, rotation as a unit
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
    ) -> Result<(), WriteError> {
        let message = self.encoder.tcp_pose(t, frame_id, position_m, rotation_xyzw)?;
        self.file.write(Topic::TcpPose, t, message)
    }

    /// Writes the flange pose in `frame_id` to `/flange_pose`, if the flange is not the TCP.
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
    ) -> Result<(), WriteError> {
        let message = self.encoder.flange_pose(t, frame_id, position_m, rotation_xyzw)?;
        self.file.write(Topic::FlangePose, t, message)
    }

    /// Writes the robot's URDF to `/robot_description`.
    ///
    /// # Errors
    ///
    /// See [`joint_state`](Self::joint_state).
    pub fn robot_description(&mut self, t: Duration, urdf: &str) -> Result<(), WriteError> {
        self.file.write(Topic::RobotDescription, t, self.encoder.robot_description(urdf)?)
    }

    /// Writes a whole trajectory that starts at `t` to `/joint_trajectory`.
    ///
    /// # Errors
    ///
    /// See [`joint_state`](Self::joint_state).
    pub fn joint_trajectory(
        &mut self,
        t: Duration,
        message: TrajectoryMessage,
    ) -> Result<(), WriteError> {
        let topic = Topic::JointTrajectory;
        let stamp = self.stamp(topic, t)?;
        let bytes = message.stamped(stamp, self.encoder.joint_stem())?;
        let (chunk, sequence, time) = self.file.place(topic, t, bytes.len())?;
        chunk.long_message(topic, sequence, time, bytes);
        Ok(())
    }

    /// Writes the start of a path piece to `/motion`.
    ///
    /// # Errors
    ///
    /// [`WriteError::NoSuchJoint`] for a limiting joint other than 1 to 7, and the errors of
    /// [`joint_state`](Self::joint_state).
    pub fn motion(&mut self, t: Duration, motion: &MotionEntry<'_>) -> Result<(), WriteError> {
        self.file.write(Topic::Motion, t, self.encoder.motion(t, motion)?)
    }

    /// Attaches a file, dated at the epoch. Ends the current chunk, so attach before or after the
    /// messages rather than between them.
    ///
    /// # Errors
    ///
    /// [`WriteError::Mcap`].
    pub fn attach(&mut self, name: &str, media_type: &str, bytes: &[u8]) -> Result<(), WriteError> {
        let header = AttachmentHeader {
            log_time: self.file.epoch_ns,
            create_time: self.file.epoch_ns,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
        };
        Ok(self.file.container.attach(header, bytes)?)
    }

    /// Writes a metadata record. Ends the current chunk, like [`attach`](Self::attach).
    ///
    /// # Errors
    ///
    /// [`WriteError::Mcap`].
    pub fn metadata(
        &mut self,
        name: &str,
        entries: &BTreeMap<String, String>,
    ) -> Result<(), WriteError> {
        Ok(self.file.container.metadata(name, entries)?)
    }

    /// Writes the summary, flushes and returns the stream.
    ///
    /// # Errors
    ///
    /// [`WriteError::Mcap`].
    pub fn finish(self) -> Result<W, WriteError> {
        Ok(self.file.container.finish()?)
    }

    /// Ends the current chunk; all messages so far are then in the stream.
    pub(crate) fn end_chunk(&mut self) -> Result<(), WriteError> {
        Ok(self.file.container.end_chunk()?)
    }

    /// Ends the current chunk and pads the file with a record that readers skip.
    pub(crate) fn pad(&mut self, bytes: &[u8]) -> Result<(), WriteError> {
        Ok(self.file.container.pad(bytes)?)
    }

    /// Bytes of the file written so far.
    pub(crate) fn offset(&self) -> u64 {
        self.file.container.offset()
    }

    /// Content of the summary up to now.
    pub(crate) fn index(&self) -> &Index {
        self.file.container.index()
    }

    pub(crate) fn stream_mut(&mut self) -> &mut W {
        self.file.container.stream_mut()
    }

    /// Stamp of `t` as in messages.
    pub(crate) fn stamp(&self, topic: Topic, t: Duration) -> Result<Time, WriteError> {
        self.encoder.stamp(topic, t)
    }
}

impl<W: Write> File<W> {
    fn write(&mut self, topic: Topic, t: Duration, bytes: &[u8]) -> Result<(), WriteError> {
        let (chunk, sequence, time) = self.place(topic, t, bytes.len())?;
        chunk.message(topic, sequence, time, bytes);
        Ok(())
    }

    /// Returns the chunk for the next message of a topic, its sequence number and its log time.
    fn place(
        &mut self,
        topic: Topic,
        t: Duration,
        data_bytes: usize,
    ) -> Result<(&mut Chunk, u32, u64), WriteError> {
        let epoch = self.epoch;
        let time = epoch
            .checked_add(t)
            .filter(|instant| Time::from_duration(*instant).is_some())
            .and_then(|instant| u64::try_from(instant.as_nanos()).ok())
            .ok_or(WriteError::StampOutOfRange { topic, t, epoch })?;

        let place = topic as usize;
        let channel = self.channels[place];
        if let Some(previous) = channel.last.filter(|last| t <= *last) {
            return Err(WriteError::NotIncreasing { topic, t, previous });
        }
        let chunk = self.container.chunk_for(data_bytes)?;
        if !channel.open {
            chunk.define(topic)?;
        }
        let sequence = channel.sequence;
        self.channels[place] =
            TopicState { open: true, sequence: sequence.wrapping_add(1), last: Some(t) };
        Ok((chunk, sequence, time))
    }
}
