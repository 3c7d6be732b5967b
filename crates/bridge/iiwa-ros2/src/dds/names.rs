//! ROS names: namespaces, topics, the action.

use ros2_client::{ActionTypeName, MessageTypeName, Name, NodeName, ServiceTypeName};

use super::error::Ros2Error;

/// Name of each robot's node, in the robot's namespace.
const NODE: &str = "iiwasim_bridge";

/// Name of the trajectory controller in `ros2_control`: `MoveIt` expects the action in its
/// namespace.
const CONTROLLER: &str = "joint_trajectory_controller";

/// ROS names of one robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NodeNames {
    /// Namespace of its topics: `/`, or `/cell_1`.
    namespace: String,
}

impl NodeNames {
    /// Creates names in a namespace such as `/cell_1` or `cell_1/left`; an empty one, or `/`, is
    /// the root namespace.
    ///
    /// # Errors
    ///
    /// The namespace is invalid in ROS.
    pub(super) fn new(namespace: &str) -> Result<Self, Ros2Error> {
        let tokens = namespace.trim_matches('/');
        let names = Self { namespace: format!("/{tokens}") };
        let fault = |_| Ros2Error::Namespace { namespace: namespace.to_owned() };
        names.topic("any").map_err(fault)?;
        Ok(names)
    }

    pub(super) fn namespace(&self) -> &str {
        &self.namespace
    }

    pub(super) fn node(&self) -> Result<NodeName, Ros2Error> {
        Ok(NodeName::new(&self.namespace, NODE)?)
    }

    pub(super) fn topic(&self, name: &str) -> Result<Name, ros2_client::names::NameError> {
        Name::new(&self.namespace, name)
    }

    /// Returns the name of the controller's `follow_joint_trajectory` action.
    pub(super) fn action(&self) -> Result<Name, Ros2Error> {
        let namespace = self.namespace.trim_end_matches('/');
        Ok(Name::new(&format!("{namespace}/{CONTROLLER}"), "follow_joint_trajectory")?)
    }

    pub(super) fn action_type() -> ActionTypeName {
        ActionTypeName::new("control_msgs", "FollowJointTrajectory")
    }

    pub(super) fn service_type() -> ServiceTypeName {
        ServiceTypeName::new("iiwasim_msgs", "TimeJointPath")
    }

    pub(super) fn joint_state_type() -> MessageTypeName {
        MessageTypeName::new("sensor_msgs", "JointState")
    }

    pub(super) fn tf_type() -> MessageTypeName {
        MessageTypeName::new("tf2_msgs", "TFMessage")
    }

    pub(super) fn path_type() -> MessageTypeName {
        MessageTypeName::new("trajectory_msgs", "JointTrajectory")
    }

    pub(super) fn text_type() -> MessageTypeName {
        MessageTypeName::new("std_msgs", "String")
    }
}

/// Derives a namespace from a robot name, which may contain characters that ROS does not allow:
/// `cell-1` becomes `cell_1`, and `1.left` becomes `robot_1_left`.
#[must_use]
pub fn namespace_of(robot: &str) -> String {
    let mut namespace = String::with_capacity(robot.len() + 6);
    if !robot.starts_with(|first: char| first.is_ascii_alphabetic()) {
        namespace.push_str("robot_");
    }
    for letter in robot.chars() {
        let letter = if letter.is_ascii_alphanumeric() { letter } else { '_' };
        // ROS reserves double underscores as a separator.
        if letter != '_' || !namespace.ends_with('_') {
            namespace.push(letter);
        }
    }
    namespace.trim_end_matches('_').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn namespaces_follow_from_the_names_of_robots() {
        for (robot, namespace) in [
            ("cell-1", "cell_1"),
            ("left", "left"),
            ("1.left", "robot_1_left"),
            ("a--b_", "a_b"),
            ("_", "robot"),
        ] {
            assert_eq!(namespace_of(robot), namespace);
            assert!(NodeNames::new(&namespace_of(robot)).is_ok());
        }
    }

    #[test]
    fn topics_are_within_the_namespace() {
        let topic = |namespace: &str| {
            let names = NodeNames::new(namespace).unwrap();
            let action = names.action().unwrap();
            (names.topic("joint_states").unwrap().to_string(), action.to_string())
        };
        let action = "/joint_trajectory_controller/follow_joint_trajectory";
        assert_eq!(topic(""), ("/joint_states".to_owned(), action.to_owned()));
        assert_eq!(topic("/"), topic(""));
        let (states, action_name) = topic("/cell_1");
        assert_eq!(
            (states.as_str(), action_name),
            ("/cell_1/joint_states", format!("/cell_1{action}"))
        );
        assert!(NodeNames::new("cell-1").is_err());
        assert!(NodeNames::new("a//b").is_err());
    }
}
