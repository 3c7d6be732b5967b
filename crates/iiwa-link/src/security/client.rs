//! What a client needs to be let in, and to know that the server is the right one.

use std::path::Path;

use super::{Endpoint, KeyPair, PublicKey, SecurityError, require_curve};

/// A client's own keys and its server's public key.
#[derive(Clone, Debug)]
pub struct ClientSecurity {
    /// Its keys.
    pub pair: KeyPair,
    /// The server's public key.
    pub server: PublicKey,
}

impl ClientSecurity {
    /// Reads a file with a secret key, and one with the server's public key.
    ///
    /// # Errors
    /// As [`KeyPair::read`] and [`PublicKey::read`]; the libzmq of this build has no CURVE.
    pub fn read(key: &Path, server_key: &Path) -> Result<Self, SecurityError> {
        require_curve()?;
        Ok(Self { pair: KeyPair::read(key)?, server: PublicKey::read(server_key)? })
    }

    /// Makes a socket use the keys for what it connects to from now on.
    ///
    /// # Errors
    /// The libzmq of this build has no CURVE, or refuses.
    pub fn apply(&self, socket: &zmq::Socket) -> Result<(), SecurityError> {
        require_curve()?;
        socket
            .set_curve_serverkey(self.server.bytes())
            .and_then(|()| socket.set_curve_publickey(self.pair.public().bytes()))
            .and_then(|()| socket.set_curve_secretkey(self.pair.secret()))
            .map_err(SecurityError::zmq("give a socket its keys"))
    }
}

/// Connects a socket, with the keys if there are any.
///
/// # Errors
/// As [`Endpoint::check_connect`] and [`ClientSecurity::apply`]; libzmq refuses the address.
pub fn connect(
    socket: &zmq::Socket,
    endpoint: &Endpoint,
    security: Option<&ClientSecurity>,
) -> Result<(), SecurityError> {
    endpoint.check_connect(security.is_some())?;
    if let Some(security) = security {
        security.apply(socket)?;
    }
    let address = endpoint.to_string();
    socket
        .set_ipv6(endpoint.is_ipv6())
        .and_then(|()| socket.connect(&address))
        .map_err(SecurityError::zmq(format!("connect to {address}")))
}
