//! Why a drive, a cabinet or a client could not be set up.

use std::io;

use crate::security::SecurityError;

/// Why a drive, a cabinet or a client could not be set up.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinkError {
    /// The address of FRI cannot be bound.
    #[error("cannot listen at UDP {address}")]
    Udp {
        /// The address.
        address: String,
        /// What the system says.
        source: io::Error,
    },
    /// An address cannot be bound.
    #[error("cannot listen at {at}")]
    Bind {
        /// The address.
        at: String,
        /// What the system says.
        source: io::Error,
    },
    /// A thread cannot be started.
    #[error("cannot start a thread")]
    Thread {
        /// What the system says.
        source: io::Error,
    },
    /// Addresses or keys are not safe, or do not fit.
    #[error(transparent)]
    Security(#[from] SecurityError),
    /// The drive does not let this client in.
    #[error("the drive at {at} does not let this client in: {what}")]
    Unauthorized {
        /// The address.
        at: String,
        /// What it has against it.
        what: &'static str,
    },
    /// The configuration makes no sense.
    #[error("{what}")]
    Config {
        /// What is wrong.
        what: String,
    },
}
