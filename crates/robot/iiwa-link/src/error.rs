//! Setup errors of a drive, a cabinet or a client.

use std::{io, net::SocketAddr};

use crate::security::SecurityError;

/// Setup error of a drive, a cabinet or a client.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinkError {
    /// The UDP address for FRI cannot be bound.
    #[error("cannot listen at UDP {address}")]
    Udp {
        /// The address.
        address: String,
        /// The system's error.
        source: io::Error,
    },
    /// A TCP address cannot be bound.
    #[error("cannot listen at {address}")]
    Bind {
        /// The address.
        address: String,
        /// The system's error.
        source: io::Error,
    },
    /// The limit of open files is too low to accept connections.
    #[error(
        "the process may open {limit} files at a time, but needs at least {needed} to accept \
         connections"
    )]
    OpenFiles {
        /// The limit of open files.
        limit: u64,
        /// The lowest sufficient limit.
        needed: u64,
    },
    /// A thread cannot be started.
    #[error("cannot start a thread")]
    Thread {
        /// The system's error.
        source: io::Error,
    },
    /// Keys are missing or unusable, or an address is invalid.
    #[error(transparent)]
    Security(#[from] SecurityError),
    /// The drive has refused the connection.
    #[error("the drive at {address} refused the connection: {reason}")]
    Unauthorized {
        /// The address.
        address: String,
        /// The reason.
        reason: &'static str,
    },
    /// FRI listens at an address that other machines can reach, but accepts messages of this
    /// machine only.
    #[error("no controller can reach FRI at {fri}: the controller's address is a loopback address")]
    ControllerAddress {
        /// The address that FRI listens on.
        fri: SocketAddr,
    },
    /// The FRI client is on another machine, and keys are missing.
    #[error("the FRI client {client} is on another machine, so CURVE keys are required")]
    FriNeedsKeys {
        /// The address of the client.
        client: SocketAddr,
    },
    /// The configuration is invalid.
    #[error("{message}")]
    Config {
        /// The fault.
        message: String,
    },
}
