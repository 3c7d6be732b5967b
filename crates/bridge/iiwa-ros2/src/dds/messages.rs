//! ROS 2 messages as encoded in CDR: fields in order.

use std::time::{Duration as Span, SystemTime, UNIX_EPOCH};

use iiwa_kin::Joints;
use ros2_client::Message;
use serde::{Deserialize, Serialize};

/// `builtin_interfaces/msg/Time`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Time {
    pub(super) sec: i32,
    pub(super) nanosec: u32,
}

impl Time {
    pub(super) fn now() -> Self {
        Self::from(SystemTime::now())
    }

    pub(super) fn is_zero(self) -> bool {
        self == Self::default()
    }

    /// Returns the time in s since 1970.
    pub(super) fn seconds(self) -> f64 {
        f64::from(self.sec) + 1e-9 * f64::from(self.nanosec)
    }
}

impl From<SystemTime> for Time {
    fn from(time: SystemTime) -> Self {
        let since = time.duration_since(UNIX_EPOCH).unwrap_or_default();
        // 2038 is the last year that the message can represent.
        let sec = i32::try_from(since.as_secs()).unwrap_or(i32::MAX);
        Self { sec, nanosec: since.subsec_nanos() }
    }
}

/// `builtin_interfaces/msg/Duration`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Duration {
    pub(super) sec: i32,
    pub(super) nanosec: u32,
}

impl Duration {
    pub(super) fn seconds(self) -> f64 {
        f64::from(self.sec) + 1e-9 * f64::from(self.nanosec)
    }

    /// Creates a duration from non-negative seconds.
    pub(super) fn from_seconds(seconds: f64) -> Self {
        let span = Span::try_from_secs_f64(seconds).unwrap_or_default();
        Self {
            sec: i32::try_from(span.as_secs()).unwrap_or(i32::MAX),
            nanosec: span.subsec_nanos(),
        }
    }
}

/// `std_msgs/msg/Header`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Header {
    pub(super) stamp: Time,
    pub(super) frame_id: String,
}

/// `std_msgs/msg/String`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Text {
    pub(super) data: String,
}

/// `sensor_msgs/msg/JointState`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct JointState {
    pub(super) header: Header,
    pub(super) name: Vec<String>,
    pub(super) position: Vec<f64>,
    pub(super) velocity: Vec<f64>,
    pub(super) effort: Vec<f64>,
}

/// `geometry_msgs/msg/Transform`: translation, and rotation as x, y, z, w.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Transform {
    pub(super) translation: [f64; 3],
    pub(super) rotation: [f64; 4],
}

/// `geometry_msgs/msg/TransformStamped`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct TransformStamped {
    pub(super) header: Header,
    pub(super) child_frame_id: String,
    pub(super) transform: Transform,
}

/// `tf2_msgs/msg/TFMessage`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct TfMessage {
    pub(super) transforms: Vec<TransformStamped>,
}

/// `trajectory_msgs/msg/JointTrajectoryPoint`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct JointTrajectoryPoint {
    pub(super) positions: Vec<f64>,
    pub(super) velocities: Vec<f64>,
    pub(super) accelerations: Vec<f64>,
    pub(super) effort: Vec<f64>,
    pub(super) time_from_start: Duration,
}

impl JointTrajectoryPoint {
    /// Creates a point with positions only, in rad.
    pub(super) fn of_positions(q: &Joints) -> Self {
        Self { positions: q.to_vec(), ..Self::default() }
    }
}

/// `trajectory_msgs/msg/JointTrajectory`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct JointTrajectory {
    pub(super) header: Header,
    pub(super) joint_names: Vec<String>,
    pub(super) points: Vec<JointTrajectoryPoint>,
}

/// `geometry_msgs/msg/Twist`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Twist {
    linear: [f64; 3],
    angular: [f64; 3],
}

/// `trajectory_msgs/msg/MultiDOFJointTrajectoryPoint`, for joints that this robot does not have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct MultiDofPoint {
    transforms: Vec<Transform>,
    velocities: Vec<Twist>,
    accelerations: Vec<Twist>,
    time_from_start: Duration,
}

/// `trajectory_msgs/msg/MultiDOFJointTrajectory`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct MultiDofTrajectory {
    header: Header,
    joint_names: Vec<String>,
    pub(super) points: Vec<MultiDofPoint>,
}

/// `control_msgs/msg/JointTolerance`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct JointTolerance {
    pub(super) name: String,
    pub(super) position: f64,
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
    effort: f64,
}

#[cfg(test)]
impl JointTolerance {
    pub(super) fn of_position(name: &str, position: f64) -> Self {
        Self { name: name.to_owned(), position, velocity: 0.0, acceleration: 0.0, effort: 0.0 }
    }
}

/// `control_msgs/msg/JointComponentTolerance`, for joints that this robot does not have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct JointComponentTolerance {
    joint_name: String,
    component: u16,
    position: f64,
    velocity: f64,
    acceleration: f64,
}

/// Goal of `control_msgs/action/FollowJointTrajectory`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct FollowGoal {
    pub(super) trajectory: JointTrajectory,
    pub(super) multi_dof_trajectory: MultiDofTrajectory,
    pub(super) path_tolerance: Vec<JointTolerance>,
    component_path_tolerance: Vec<JointComponentTolerance>,
    pub(super) goal_tolerance: Vec<JointTolerance>,
    component_goal_tolerance: Vec<JointComponentTolerance>,
    goal_time_tolerance: Duration,
}

/// Result of `control_msgs/action/FollowJointTrajectory`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct FollowResult {
    pub(super) error_code: i32,
    pub(super) error_string: String,
}

impl FollowResult {
    pub(super) const SUCCESSFUL: i32 = 0;
    pub(super) const INVALID_GOAL: i32 = -1;
    pub(super) const PATH_TOLERANCE_VIOLATED: i32 = -4;
    pub(super) const GOAL_TOLERANCE_VIOLATED: i32 = -5;

    pub(super) fn new(error_code: i32, error_string: impl Into<String>) -> Self {
        Self { error_code, error_string: error_string.into() }
    }
}

/// Feedback of `control_msgs/action/FollowJointTrajectory`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct FollowFeedback {
    pub(super) header: Header,
    pub(super) joint_names: Vec<String>,
    pub(super) desired: JointTrajectoryPoint,
    pub(super) actual: JointTrajectoryPoint,
    pub(super) error: JointTrajectoryPoint,
    pub(super) multi_dof_joint_names: Vec<String>,
    pub(super) multi_dof_desired: MultiDofPoint,
    pub(super) multi_dof_actual: MultiDofPoint,
    pub(super) multi_dof_error: MultiDofPoint,
}

/// Request of `iiwasim_msgs/srv/TimeJointPath`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct TimeRequest {
    pub(super) path: JointTrajectory,
    pub(super) tolerance: f64,
    pub(super) velocity_scaling: f64,
    pub(super) acceleration_scaling: f64,
}

impl TimeRequest {
    /// Creates a request with the default tolerance, and the robot's limits.
    pub(super) fn of_path(path: JointTrajectory) -> Self {
        Self { path, tolerance: 0.0, velocity_scaling: 0.0, acceleration_scaling: 0.0 }
    }
}

/// Response of `iiwasim_msgs/srv/TimeJointPath`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct TimeResponse {
    pub(super) success: bool,
    pub(super) message: String,
    pub(super) duration: f64,
    pub(super) deviation: f64,
    pub(super) stops: u32,
}

impl Message for FollowGoal {}
impl Message for FollowResult {}
impl Message for FollowFeedback {}
impl Message for TimeRequest {}
impl Message for TimeResponse {}
