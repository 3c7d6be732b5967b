//! Errors of setting up the server.

use std::{io, net::SocketAddr, path::PathBuf};

use iiwa_link::LinkError;

/// Why a server could not be set up.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OpcUaError {
    /// An address cannot be listened at.
    #[error("cannot listen at {at}")]
    Listen {
        /// The address.
        at: SocketAddr,
        /// The system's error.
        source: io::Error,
    },
    /// A certificate or key cannot be used.
    #[error("cannot use {}: {what}", .file.display())]
    Certificate {
        /// Its file.
        file: PathBuf,
        /// The fault.
        what: String,
    },
    /// The settings contradict each other.
    #[error("{what}")]
    Settings {
        /// The fault, and what to do about it.
        what: String,
    },
    /// Two robots have the same name.
    #[error("two robots are called `{name}`")]
    SameName {
        /// The name.
        name: String,
    },
    /// The server was not set up.
    #[error("the OPC UA server was not set up: {what}")]
    Server {
        /// The fault.
        what: String,
    },
    /// The runtime cannot be started.
    #[error("cannot start the network's runtime")]
    Runtime {
        /// The system's error.
        source: io::Error,
    },
    /// A thread cannot be started.
    #[error(transparent)]
    Link(#[from] LinkError),
}
