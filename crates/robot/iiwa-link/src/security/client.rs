//! Security of clients.

use std::path::Path;

use omq_proto::{CurvePublicKey, MechanismSetup};

use super::{
    error::SecurityError,
    key::{KeyPair, PublicKey},
};

/// A client's own keys and its server's public key.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ClientSecurity {
    /// Its own keys.
    pub pair: KeyPair,
    /// The server's public key.
    pub server: PublicKey,
}

impl ClientSecurity {
    /// These keys for a server with this public key.
    #[must_use]
    pub fn new(pair: KeyPair, server: PublicKey) -> Self {
        Self { pair, server }
    }

    /// Reads a secret key file and the server's public key file.
    ///
    /// # Errors
    /// As [`KeyPair::read`] and [`PublicKey::read`].
    pub fn read(key: &Path, server_key: &Path) -> Result<Self, SecurityError> {
        Ok(Self { pair: KeyPair::read(key)?, server: PublicKey::read(server_key)? })
    }

    /// The mechanism with these keys.
    pub(crate) fn mechanism(&self) -> MechanismSetup {
        MechanismSetup::CurveClient {
            our_keypair: self.pair.for_curve(),
            server_public: CurvePublicKey::from_bytes(*self.server.bytes()),
        }
    }
}
