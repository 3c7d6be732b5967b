//! Topics of a recording: their ROS 2 types, schemas and quality of service.

use std::fmt;

/// Topic of a recording, with its ROS 2 type.
///
/// Every topic is encoded as CDR; its schema is stored as `ros2msg` text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Topic {
    /// `/joint_states`, `sensor_msgs/msg/JointState`: positions in rad, velocities in rad/s,
    /// efforts in Nm: in plans the torques that the joints exert on the output side of the gears,
    /// in recordings the torques that the controller measures, if any, with its sign.
    JointStates,
    /// `/tf`, `tf2_msgs/msg/TFMessage`: the pose of every link in its parent; in recordings at most
    /// [`pose_rate_hz`](crate::RecorderConfig::pose_rate_hz) times per second, like `/tcp_pose`.
    Tf,
    /// `/robot_description`, `std_msgs/msg/String`: the URDF of the robot.
    RobotDescription,
    /// `/tcp_pose`, `geometry_msgs/msg/PoseStamped`: the pose of the moving TCP; of the flange
    /// without a tool, and in recordings, which do not know the tool.
    TcpPose,
    /// `/joint_trajectory`, `trajectory_msgs/msg/JointTrajectory`: the whole trajectory.
    JointTrajectory,
    /// `/motion`, `iiwasim_msgs/msg/Motion`: the start of a path piece.
    Motion,
    /// `/flange_pose`, `geometry_msgs/msg/PoseStamped`: the flange pose; only for programs with a
    /// tool.
    FlangePose,
    /// `/diagnostics`, `diagnostic_msgs/msg/DiagnosticArray`: the drive's state, temperatures,
    /// inputs and outputs; only in recordings.
    Diagnostics,
}

impl Topic {
    /// All topics, in the order of their channel numbers in a file.
    pub const ALL: [Self; 8] = [
        Self::JointStates,
        Self::Tf,
        Self::RobotDescription,
        Self::TcpPose,
        Self::JointTrajectory,
        Self::Motion,
        Self::FlangePose,
        Self::Diagnostics,
    ];

    /// MCAP name of the message encoding.
    pub const MESSAGE_ENCODING: &str = "cdr";

    /// MCAP name of the schema encoding.
    pub const SCHEMA_ENCODING: &str = "ros2msg";

    /// Number of the topic's channel and schema in a file, from 1: fixed, so that it does not
    /// depend on the order of the calls.
    pub(crate) fn id(self) -> u16 {
        self as u16 + 1
    }

    /// Name of the topic, with its leading slash.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::JointStates => "/joint_states",
            Self::Tf => "/tf",
            Self::RobotDescription => "/robot_description",
            Self::TcpPose => "/tcp_pose",
            Self::JointTrajectory => "/joint_trajectory",
            Self::Motion => "/motion",
            Self::FlangePose => "/flange_pose",
            Self::Diagnostics => "/diagnostics",
        }
    }

    /// Returns the topic of this name, if a recording has it.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|topic| topic.name() == name)
    }

    /// Full name of the ROS 2 type, `package/msg/Name`.
    #[must_use]
    pub fn type_name(self) -> &'static str {
        match self {
            Self::JointStates => "sensor_msgs/msg/JointState",
            Self::Tf => "tf2_msgs/msg/TFMessage",
            Self::RobotDescription => "std_msgs/msg/String",
            Self::TcpPose | Self::FlangePose => "geometry_msgs/msg/PoseStamped",
            Self::JointTrajectory => "trajectory_msgs/msg/JointTrajectory",
            Self::Motion => "iiwasim_msgs/msg/Motion",
            Self::Diagnostics => "diagnostic_msgs/msg/DiagnosticArray",
        }
    }

    /// Schema as `ros2msg` text: the fields of the type, then for every type that they need a line
    /// of 80 equals signs, a line `MSG: package/Name` and its fields.
    #[must_use]
    pub fn schema(self) -> String {
        let (fields, needs): (&str, &[&Definition]) = match self {
            Self::JointStates => (
                "std_msgs/Header header\nstring[] name\nfloat64[] position\n\
                 float64[] velocity\nfloat64[] effort\n",
                &[&HEADER, &TIME],
            ),
            Self::Tf => (
                "geometry_msgs/TransformStamped[] transforms\n",
                &[&TRANSFORM_STAMPED, &HEADER, &TIME, &TRANSFORM, &VECTOR3, &QUATERNION],
            ),
            Self::RobotDescription => ("string data\n", &[]),
            Self::TcpPose | Self::FlangePose => (
                "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
                &[&HEADER, &TIME, &POSE, &POINT, &QUATERNION],
            ),
            Self::JointTrajectory => (
                "std_msgs/Header header\nstring[] joint_names\n\
                 trajectory_msgs/JointTrajectoryPoint[] points\n",
                &[&HEADER, &TIME, &JOINT_TRAJECTORY_POINT, &DURATION],
            ),
            Self::Motion => (
                "std_msgs/Header header\nuint32 index\nstring kind\n\
                 uint32 limiting_joint\nstring limiting_kind\nstring name\nstring group\n",
                &[&HEADER, &TIME],
            ),
            Self::Diagnostics => (
                "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n",
                &[&HEADER, &TIME, &DIAGNOSTIC_STATUS, &KEY_VALUE],
            ),
        };
        let mut text = String::from(fields);
        for (name, fields) in needs {
            text.push_str(&"=".repeat(80));
            text.push_str("\nMSG: ");
            text.push_str(name);
            text.push('\n');
            text.push_str(fields);
        }
        text
    }

    /// Quality of service that a publisher of this topic offers, as rosbag2 writes it into a bag of
    /// format version 8 and earlier: numbers for the policies of `rmw`, and 2^63 - 1 ns for no time
    /// limit. Descriptions and trajectories are kept for late subscribers, all other topics are
    /// volatile.
    #[must_use]
    pub fn offered_qos_profiles(self) -> &'static str {
        match self {
            Self::RobotDescription | Self::JointTrajectory => LATCHED,
            Self::JointStates
            | Self::Tf
            | Self::TcpPose
            | Self::Motion
            | Self::FlangePose
            | Self::Diagnostics => VOLATILE,
        }
    }
}

impl fmt::Display for Topic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Name and fields of a nested type.
type Definition = (&'static str, &'static str);

const TIME: Definition = ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
const DURATION: Definition = ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n");
const HEADER: Definition = ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n");
const POINT: Definition = ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n");
const VECTOR3: Definition = ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n");
const QUATERNION: Definition =
    ("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n");
const POSE: Definition =
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n");
const TRANSFORM: Definition = (
    "geometry_msgs/Transform",
    "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
);
const TRANSFORM_STAMPED: Definition = (
    "geometry_msgs/TransformStamped",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
);
const JOINT_TRAJECTORY_POINT: Definition = (
    "trajectory_msgs/JointTrajectoryPoint",
    "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\n\
     builtin_interfaces/Duration time_from_start\n",
);

const DIAGNOSTIC_STATUS: Definition = (
    "diagnostic_msgs/DiagnosticStatus",
    "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\nstring name\nstring message\n\
     string hardware_id\ndiagnostic_msgs/KeyValue[] values\n",
);
const KEY_VALUE: Definition = ("diagnostic_msgs/KeyValue", "string key\nstring value\n");

macro_rules! qos {
    (depth: $depth:literal, durability: $durability:literal) => {
        concat!(
            "- history: 1\n  depth: ",
            $depth,
            "\n  reliability: 1\n  durability: ",
            $durability,
            "\n  deadline:\n    sec: 9223372036\n    nsec: 854775807\n",
            "  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n",
            "  liveliness: 1\n",
            "  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n",
            "  avoid_ros_namespace_conventions: false"
        )
    };
}

/// Quality of service: keep the last message, reliable, transient-local.
const LATCHED: &str = qos!(depth: "1", durability: "1");
/// Quality of service: keep the last hundred messages, reliable, volatile.
const VOLATILE: &str = qos!(depth: "100", durability: "2");

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the schema with the message definition that ROS 2 builds.
    #[test]
    fn the_package_of_messages_has_the_fields_of_the_schema() {
        let path =
            concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/ros/iiwasim_msgs/msg/Motion.msg");
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let fields = text.lines().filter(|line| !line.starts_with('#'));
        let schema = Topic::Motion.schema();
        assert!(fields.eq(schema.lines().take_while(|line| !line.starts_with('='))));
    }
}
