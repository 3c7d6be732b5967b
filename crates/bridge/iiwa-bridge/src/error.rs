//! Setup errors of a bridge.

use std::{io, path::PathBuf};

use iiwa_link::LinkError;

/// Setup error of a bridge.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BridgeError {
    /// The robot name cannot be part of topics and paths.
    #[error("invalid robot name `{name}`: use 1 to 64 letters, digits, `-` and `_`")]
    RobotName {
        /// The name.
        name: String,
    },
    /// Two robots have the same name.
    #[error("two robots are called `{name}`")]
    SameName {
        /// The name.
        name: String,
    },
    /// A connection to a drive cannot be set up.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The folder of a spool cannot be used.
    #[error("cannot use the spool in {}", .folder.display())]
    Spool {
        /// The folder.
        folder: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// Another bridge uses the spool.
    #[error(
        "another bridge uses the spool in {}; give each a folder of its own",
        .folder.display()
    )]
    SpoolInUse {
        /// The folder.
        folder: PathBuf,
    },
    /// A certificate or key cannot be used.
    #[error("cannot use {}: {message}", .file.display())]
    Certificate {
        /// The file.
        file: PathBuf,
        /// The fault.
        message: String,
    },
    /// The settings of a broker contradict each other.
    #[error("{message}")]
    Settings {
        /// The fault and its remedy.
        message: String,
    },
    /// A broker refuses the connection or is unreachable.
    #[error("{broker} at {address}: {message}")]
    Broker {
        /// `Kafka` or `MQTT`.
        broker: &'static str,
        /// The address.
        address: String,
        /// The fault.
        message: String,
    },
    /// The runtime cannot be started.
    #[error("cannot start the network's runtime")]
    Runtime {
        /// The system's error.
        source: io::Error,
    },
}
