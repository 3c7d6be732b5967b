//! Setup errors of the ROS bridge.

use iiwa_link::LinkError;
use ros2_client::{CreateError, NodeCreateError, names::NameError};

/// Setup error of the ROS bridge.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Ros2Error {
    /// The namespace is invalid in ROS.
    #[error(
        "`{namespace}` is not a namespace in ROS: names of letters, digits and `_`, with a letter \
         first and no `__`, and `/` between them"
    )]
    Namespace {
        /// The namespace.
        namespace: String,
    },
    /// Two robots would have the same topics.
    #[error(
        "robots `{one}` and `{other}` would have the same topics, in `{namespace}`; give them \
         other names"
    )]
    SameNamespace {
        /// Name of one robot.
        one: String,
        /// Name of the other robot.
        other: String,
        /// The namespace of both.
        namespace: String,
    },
    /// Two robots would have the same frames in `/tf`.
    #[error(
        "robots `{one}` and `{other}` would have the same frames in /tf; give each a prefix of its \
         own"
    )]
    SameFrames {
        /// Name of one robot.
        one: String,
        /// Name of the other robot.
        other: String,
    },
    /// The domain has no valid ports.
    #[error("domain {found}: ROS has domains from 0 to {max}; their ports follow from it")]
    Domain {
        /// The configured domain.
        found: u16,
        /// The last valid domain.
        max: u16,
    },
    /// DDS cannot be started.
    #[error("DDS cannot be started in domain {domain}: {message}")]
    Dds {
        /// The domain.
        domain: u16,
        /// The fault.
        message: String,
    },
    /// A name is invalid in ROS.
    #[error("a name that ROS does not allow: {0}")]
    Name(#[from] NameError),
    /// A node cannot be created.
    #[error("cannot make a node: {0}")]
    Node(#[from] NodeCreateError),
    /// A topic, service or action cannot be created.
    #[error("cannot make a topic or service: {0}")]
    Create(#[from] CreateError),
    /// A connection to the drive, or a thread, cannot be set up.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The runtime cannot be started.
    #[error("cannot start the runtime of ROS")]
    Runtime {
        /// The system's error.
        source: std::io::Error,
    },
}
