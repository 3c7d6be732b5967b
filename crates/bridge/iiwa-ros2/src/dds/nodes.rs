//! Robots as ROS 2 nodes.

use std::collections::HashMap;

use iiwa_bridge::{Content, Message, Sink};
use ros2_client::{Context, dds::rustdds::DomainParticipantBuilder};

use super::{
    error::Ros2Error,
    options::{Ros2Options, Ros2Robot},
    robot::RobotNode,
};

/// Last domain whose ports are valid on all systems: the ports of higher domains overlap with
/// ephemeral ports.
const LAST_DOMAIN: u16 = 101;

/// Robots as ROS nodes. Dropping this value removes the nodes.
pub struct Ros2 {
    nodes: HashMap<String, RobotNode>,
    // Dropped after the nodes.
    _context: Context,
}

impl std::fmt::Debug for Ros2 {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Ros2").field("robots", &self.nodes.keys()).finish_non_exhaustive()
    }
}

impl Ros2 {
    /// Starts a node for each robot.
    ///
    /// # Errors
    ///
    /// Names are invalid in ROS or shared by two robots, a domain has no free ports, a drive
    /// address is invalid, or a thread cannot be started.
    pub fn start(options: &Ros2Options) -> Result<Self, Ros2Error> {
        check_names(&options.robots)?;
        if options.domain > LAST_DOMAIN {
            return Err(Ros2Error::Domain { found: options.domain, max: LAST_DOMAIN });
        }
        let dds = |message: String| Ros2Error::Dds { domain: options.domain, message };
        let participant = DomainParticipantBuilder::new(options.domain)
            .with_only_networks(options.networks.iter().copied())
            .build()
            .map_err(|error| dds(error.to_string()))?;
        let context = Context::from_domain_participant(participant)
            .map_err(|error| dds(error.to_string()))?;
        let mut nodes = HashMap::new();
        for robot in &options.robots {
            let node = RobotNode::start(&context, robot, options)?;
            nodes.insert(robot.bridged.name().to_owned(), node);
        }
        Ok(Self { nodes, _context: context })
    }
}

fn check_names(robots: &[Ros2Robot]) -> Result<(), Ros2Error> {
    for (i, one) in robots.iter().enumerate() {
        for other in &robots[..i] {
            let [one_name, other_name] = [other, one].map(|robot| robot.bridged.name().to_owned());
            if one.namespace.trim_matches('/') == other.namespace.trim_matches('/') {
                let namespace = format!("/{}", one.namespace.trim_matches('/'));
                return Err(Ros2Error::SameNamespace {
                    one: one_name,
                    other: other_name,
                    namespace,
                });
            }
            if one.names.links() == other.names.links() {
                return Err(Ros2Error::SameFrames { one: one_name, other: other_name });
            }
        }
    }
    Ok(())
}

impl Sink for Ros2 {
    fn take(&self, message: &Message) {
        let Some(node) = self.nodes.get(&message.robot) else { return };
        match &message.content {
            Content::Joints(sample) => node.sample(message.at, sample),
            Content::State { t_s, state } => node.state(*t_s, *state),
            _ => {}
        }
    }
}
