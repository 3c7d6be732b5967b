//! Content of a recording: samples, attachments and metadata.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use crate::trajectory::TrajectoryPoint;

/// One entry of a recording. Times are in s since the [epoch](crate::Reader::epoch).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Entry {
    /// A message of `/joint_states`.
    JointState(JointSample),
    /// A message of `/tcp_pose`.
    TcpPose(PoseSample),
    /// A message of `/flange_pose`.
    FlangePose(PoseSample),
    /// A message of `/motion`.
    Motion(MotionSample),
    /// A message of `/joint_trajectory`.
    Trajectory {
        /// Start of the trajectory, s.
        t_s: f64,
        /// Nodes of the trajectory.
        points: Vec<TrajectoryPoint>,
    },
    /// A message of `/robot_description`.
    RobotDescription {
        /// Publication time, s.
        t_s: f64,
        /// Robot description.
        urdf: String,
    },
    /// An attachment.
    Attachment(Attachment),
    /// A metadata record.
    Metadata {
        /// Name of the record.
        name: String,
        /// Keys and values of the record.
        entries: BTreeMap<String, String>,
    },
}

/// State of the seven joints at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSample {
    /// Time since the epoch, s.
    pub t_s: f64,
    /// Log time since the epoch, s.
    pub log_s: f64,
    /// `false` if the header has a stamp of zero, as if it was never set.
    pub is_stamped: bool,
    /// Joint positions, rad.
    pub q: [f64; 7],
    /// Joint velocities, rad/s, if the message has them: ROS drivers may leave them out.
    pub dq: Option<[f64; 7]>,
    /// Torques, Nm, if the file has them: in a plan the torques that the joints exert, in a
    /// recording the measured ones.
    pub torques_nm: Option<[f64; 7]>,
}

/// Pose of the TCP or the flange at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseSample {
    /// Time since the epoch, s.
    pub t_s: f64,
    /// Frame in which the pose is expressed.
    pub frame_id: Arc<str>,
    /// Origin, m.
    pub position_m: [f64; 3],
    /// Rotation, unit quaternion x, y, z, w.
    pub rotation_xyzw: [f64; 4],
}

/// Path piece, written at its start time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MotionEntry<'a> {
    /// Number of the motion in the program, from 1.
    pub index: u32,
    /// Kind: `line`, `lin`, `circ`, `spline`, `blend`, `settle` or `wait`.
    pub kind: Cow<'a, str>,
    /// Joint of the active limit, 1 to 7; `None` if the active limit does not belong to a joint.
    pub limiting_joint: Option<u8>,
    /// Active limit: `velocity`, `acceleration` or `jerk`, with the prefix `cart_` or
    /// `orientation_` for TCP limits; `torque`; `minimum_duration`; `t1_velocity`; the name of
    /// another limit; empty at standstill.
    pub limiting_kind: Cow<'a, str>,
    /// Name of the motion; `None` without one, and in files of earlier versions.
    pub name: Option<Cow<'a, str>>,
    /// Group of the motion; `None` without one, and in files of earlier versions.
    pub group: Option<Cow<'a, str>>,
}

/// Start of a path piece.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionSample {
    /// Time since the epoch, s.
    pub t_s: f64,
    /// Piece that begins.
    pub motion: MotionEntry<'static>,
}

/// File inside the recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// File name.
    pub name: String,
    /// Media type, such as `application/json`.
    pub media_type: String,
    /// Content.
    pub bytes: Vec<u8>,
}
