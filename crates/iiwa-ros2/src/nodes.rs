//! Robots as nodes of ROS 2.

use std::{
    collections::HashMap,
    net::{IpAddr, Ipv4Addr},
};

use iiwa_bridge::{BridgedRobot, Content, Message, Sink};
use iiwa_kin::{Robot, RosNames};
use ros2_client::{Context, dds::rustdds::DomainParticipantBuilder};

use crate::{error::Ros2Error, retiming::RetimeGoals, robot::RobotNode};

/// The last domain whose ports exist on all systems: others are taken for outgoing connections.
const LAST_DOMAIN: u16 = 101;

/// How robots appear in ROS.
#[derive(Clone, Debug)]
pub struct Ros2Options {
    /// The DDS domain, as `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// The addresses of this machine that are announced, and used for multicast. Loopback alone by default.
    pub networks: Vec<IpAddr>,
    /// The robots.
    pub robots: Vec<Ros2Robot>,
    /// Whether goals are taken.
    pub allow_commands: bool,
    /// Most messages a second on `/tf`.
    pub tf_rate_hz: f64,
    /// When goals get new times on their path, unless the node's parameter `retime` says something else.
    pub retime: RetimeGoals,
}

impl Default for Ros2Options {
    fn default() -> Self {
        Self {
            domain: 0,
            networks: vec![IpAddr::V4(Ipv4Addr::LOCALHOST)],
            robots: Vec::new(),
            allow_commands: false,
            tf_rate_hz: 100.0,
            retime: RetimeGoals::default(),
        }
    }
}

/// A robot of the bridge, as it appears in ROS.
#[derive(Clone, Debug)]
pub struct Ros2Robot {
    /// Its drive.
    pub bridged: BridgedRobot,
    /// Its model.
    pub robot: Robot,
    /// Names of joints and links.
    pub names: RosNames,
    /// Of its topics; empty for none.
    pub namespace: String,
}

/// Robots as nodes of ROS. They vanish from it when this is dropped.
pub struct Ros2 {
    nodes: HashMap<String, RobotNode>,
    // After the nodes.
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
    /// Names that ROS does not allow or that two robots share, a domain without free ports, an address of a drive that is
    /// invalid, or a thread that cannot be started.
    pub fn start(options: &Ros2Options) -> Result<Self, Ros2Error> {
        check_names(&options.robots)?;
        if options.domain > LAST_DOMAIN {
            return Err(Ros2Error::Domain { found: options.domain, most: LAST_DOMAIN });
        }
        let dds = |what: String| Ros2Error::Dds { domain: options.domain, what };
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

/// A request or a message, if one has come.
pub(crate) fn received<T, E: std::fmt::Display>(read: Result<Option<T>, E>) -> Option<T> {
    read.unwrap_or_else(|error| {
        tracing::warn!("a message of ROS that cannot be read was passed over: {error}");
        None
    })
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
