//! What a recording consists of: samples, attachments and metadata.

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
        /// The start of the trajectory, s.
        t_s: f64,
        /// Its nodes.
        points: Vec<TrajectoryPoint>,
    },
    /// A message of `/robot_description`.
    RobotDescription {
        /// When it was published, s.
        t_s: f64,
        /// The robot.
        urdf: String,
    },
    /// An attachment.
    Attachment(Attachment),
    /// A metadata record.
    Metadata {
        /// Name of the record.
        name: String,
        /// Its keys and values.
        entries: BTreeMap<String, String>,
    },
}

/// The state of the seven joints at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSample {
    /// Time since the epoch, s.
    pub t_s: f64,
    /// Joint positions, rad.
    pub q: [f64; 7],
    /// Joint velocities, rad/s.
    pub dq: [f64; 7],
    /// Torques, Nm, if the file has them: in a plan those that the joints exert, in a recording those that were measured.
    pub torques_nm: Option<[f64; 7]>,
}

/// The pose of the TCP, or of the flange, at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseSample {
    /// Time since the epoch, s.
    pub t_s: f64,
    /// The frame that the pose is given in.
    pub frame_id: Arc<str>,
    /// Its origin, m.
    pub position_m: [f64; 3],
    /// Its rotation, unit quaternion x, y, z, w.
    pub rotation_xyzw: [f64; 4],
}

/// A piece of the path, for the time at which it begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Motion<'a> {
    /// The place in the program, from 1.
    pub index: u32,
    /// What it is: `line`, `lin`, `circ`, `spline`, `blend`, `settle` or `wait`.
    pub kind: Cow<'a, str>,
    /// The joint whose limit bites first, 1 to 7; none if it is one of the TCP.
    pub limiting_joint: Option<u8>,
    /// Which of its limits: `velocity`, `acceleration` or `jerk`, after `cart_` or `orientation_` if it is one of the
    /// TCP; empty where nothing moves.
    pub limiting_kind: Cow<'a, str>,
}

/// The start of a piece of the path.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionSample {
    /// Time since the epoch, s.
    pub t_s: f64,
    /// The piece that begins.
    pub motion: Motion<'static>,
}

/// A file inside the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// File name.
    pub name: String,
    /// Media type, such as `application/json`.
    pub media_type: String,
    /// Content.
    pub bytes: Vec<u8>,
}
