//! Setup errors of the server.

use std::{io, net::SocketAddr, path::PathBuf};

use iiwa_link::LinkError;

/// Setup error of the server.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OpcUaError {
    /// The server cannot listen at an address.
    #[error("cannot listen at {address}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// The system's error.
        source: io::Error,
    },
    /// A certificate or key cannot be used.
    #[error("cannot use {}: {message}", .file.display())]
    Certificate {
        /// The file.
        file: PathBuf,
        /// The fault.
        message: String,
    },
    /// The settings contradict each other.
    #[error("{message}")]
    Settings {
        /// The fault and its remedy.
        message: String,
    },
    /// Two robots have the same name.
    #[error("two robots are called `{name}`")]
    SameName {
        /// The name.
        name: String,
    },
    /// The server was not set up.
    #[error("the OPC UA server was not set up: {message}")]
    Server {
        /// The fault.
        message: String,
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
