//! Recording in memory.

use std::collections::BTreeMap;
use std::io::Read;
use std::time::Duration;

use crate::error::ReadError;
use crate::{
    Attachment, Entry, JointSample, MotionSample, PoseSample, Reader, Topic, TrajectoryPoint,
};

/// Whole recording in memory.
///
/// `/tf` is not read: it follows from the joint positions. [`Reader`] reads files that are too
/// large for memory.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Recording {
    /// Stamp of the first message since 1970-01-01T00:00:00Z: the instant of `t_s` = 0.
    pub epoch: Duration,
    /// `/joint_states`, in the order of the file.
    pub joint_states: Vec<JointSample>,
    /// `/tcp_pose`, in the order of the file.
    pub tcp_poses: Vec<PoseSample>,
    /// `/flange_pose`, in the order of the file; empty if the flange is the TCP.
    pub flange_poses: Vec<PoseSample>,
    /// `/motion`, in the order of the file.
    pub motions: Vec<MotionSample>,
    /// Nodes of `/joint_trajectory`; empty without such a message.
    pub trajectory: Vec<TrajectoryPoint>,
    /// `/robot_description`, a URDF.
    pub robot_description: Option<String>,
    /// Attachments, in the order of the file.
    pub attachments: Vec<Attachment>,
    /// Metadata records by name; later records overwrite entries of earlier records with the same
    /// name.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
}

impl Recording {
    /// Reads a whole recording from the bytes of a file.
    ///
    /// # Errors
    ///
    /// See [`read`](Self::read).
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        Self::read(bytes)
    }

    /// Reads a whole recording from a stream.
    ///
    /// # Errors
    ///
    /// Any [`ReadError`]: a file that is cut off or damaged, a known topic with another type or
    /// other joints, a second robot description.
    pub fn read<R: Read>(stream: R) -> Result<Self, ReadError> {
        let mut reader = Reader::new(stream);
        let mut recording = Self::default();
        for entry in reader.by_ref() {
            match entry? {
                Entry::JointState(sample) => recording.joint_states.push(sample),
                Entry::TcpPose(sample) => recording.tcp_poses.push(sample),
                Entry::FlangePose(sample) => recording.flange_poses.push(sample),
                Entry::Motion(sample) => recording.motions.push(sample),
                Entry::Trajectory { t_s, points } => {
                    let start = Duration::try_from_secs_f64(t_s).unwrap_or_default();
                    // Each further part of a long trajectory begins with the last point of the part
                    // before.
                    let last = recording.trajectory.last().map(|point| point.time_from_start);
                    recording.trajectory.extend(
                        points
                            .into_iter()
                            .map(|point| TrajectoryPoint {
                                time_from_start: start + point.time_from_start,
                                ..point
                            })
                            .filter(|point| last.is_none_or(|last| point.time_from_start > last)),
                    );
                }
                Entry::RobotDescription { t_s, urdf } => {
                    if recording.robot_description.replace(urdf).is_some() {
                        return Err(ReadError::Repeated { topic: Topic::RobotDescription, t_s });
                    }
                }
                Entry::Attachment(attachment) => recording.attachments.push(attachment),
                Entry::Metadata { name, entries } => {
                    recording.metadata.entry(name).or_default().extend(entries);
                }
            }
        }
        recording.epoch = reader.epoch().unwrap_or_default();
        Ok(recording)
    }
}
