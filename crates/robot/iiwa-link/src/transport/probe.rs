//! A single connection attempt that determines the obstacle to a connection.

use std::{io, time::Duration};

use tokio::{net::TcpStream, time::timeout};

use super::{
    runtime::runtime,
    wire::{ConnectionEnd, WireConfig, WireConnection},
};
use crate::{
    error::LinkError,
    security::{ConnectionRefusal, Endpoint},
};

/// Error of a single connection attempt.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProbeError {
    /// The address is invalid or requires keys, or the attempt could not be made.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The host name cannot be resolved.
    #[error("the name cannot be resolved")]
    UnknownHost,
    /// The host answers, but the port is not open.
    #[error("nothing listens there")]
    NothingListens,
    /// The host does not answer.
    #[error("no answer")]
    NoAnswer,
    /// Another system error.
    #[error("{0}")]
    Io(io::Error),
    /// One side has refused the keys of the other.
    #[error("{}", .0.reason())]
    Refused(ConnectionRefusal),
    /// The host accepts the connection, but the server does not complete the handshake.
    #[error("the handshake is not completed")]
    NoHandshake,
    /// The server uses another protocol.
    #[error("{message}")]
    Protocol {
        /// The fault.
        message: String,
    },
}

/// Connects once, with a time-out for the connection and one for the handshake.
pub(crate) fn probe(to: &Endpoint, config: &WireConfig, limit: Duration) -> Result<(), ProbeError> {
    let address = to.resolve().map_err(|_| ProbeError::UnknownHost)?;
    let runtime = runtime().map_err(|source| LinkError::Thread { source })?;
    runtime.block_on(async {
        let stream = match timeout(limit, TcpStream::connect(address)).await {
            Ok(Ok(stream)) => stream,
            Ok(Err(error)) => return Err(unconnected(error)),
            Err(_) => return Err(ProbeError::NoAnswer),
        };
        let mut wire = WireConnection::new(stream, config.clone());
        match timeout(limit, wire.shake_hands(|_| {})).await {
            Ok(Ok(_)) => Ok(()),
            Ok(Err(ConnectionEnd::Refused(reason))) => Err(ProbeError::Refused(reason)),
            Ok(Err(error)) => Err(ProbeError::Protocol { message: error.to_string() }),
            Err(_) => Err(ProbeError::NoHandshake),
        }
    })
}

fn unconnected(error: io::Error) -> ProbeError {
    use io::ErrorKind::{ConnectionRefused, HostUnreachable, NetworkUnreachable, TimedOut};
    match error.kind() {
        ConnectionRefused => ProbeError::NothingListens,
        HostUnreachable | NetworkUnreachable | TimedOut => ProbeError::NoAnswer,
        _ => ProbeError::Io(error),
    }
}
