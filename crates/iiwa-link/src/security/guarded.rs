//! A server's socket.

use std::ops::Deref;

use super::{Authenticator, Endpoint, SecurityError};

/// A server's socket: either it has keys and keeps its [`Authenticator`] running, or it binds to
/// loopback addresses only.
///
/// It is used as the `zmq::Socket` that it is, but bound by its own [`bind`](Self::bind).
pub struct GuardedSocket {
    // Closed before the authenticator may end: without one, libzmq would let everybody in.
    socket: zmq::Socket,
    authenticator: Option<Authenticator>,
}

impl GuardedSocket {
    /// A socket without keys.
    ///
    /// # Errors
    /// libzmq refuses to make one.
    pub fn open(context: &zmq::Context, kind: zmq::SocketType) -> Result<Self, SecurityError> {
        let socket = context.socket(kind).map_err(SecurityError::zmq("make a socket"))?;
        Ok(Self { socket, authenticator: None })
    }

    /// A socket that has its keys.
    pub(super) fn with_keys(socket: zmq::Socket, authenticator: Authenticator) -> Self {
        Self { socket, authenticator: Some(authenticator) }
    }

    /// Binds it, and returns the address that it has, with the port if that was `*`.
    ///
    /// # Errors
    /// It has no keys and the address is not on loopback, or the address is not to be had.
    pub fn bind(&self, endpoint: &Endpoint) -> Result<String, SecurityError> {
        endpoint.check_bind(self.authenticator.is_some())?;
        let address = endpoint.to_string();
        let refuse = || SecurityError::zmq(format!("bind to {address}"));
        self.socket.set_ipv6(endpoint.is_ipv6()).map_err(refuse())?;
        self.socket.bind(&address).map_err(refuse())?;
        let bound = self.socket.get_last_endpoint().map_err(refuse())?;
        Ok(bound.unwrap_or(address))
    }
}

impl Deref for GuardedSocket {
    type Target = zmq::Socket;

    fn deref(&self) -> &zmq::Socket {
        &self.socket
    }
}
