//! Client security.

use std::path::Path;

use omq_proto::{CurvePublicKey, MechanismSetup};

use super::{
    error::SecurityError,
    key::{KeyPair, PublicKey},
};

/// Key pair of a client, and the public key of its server.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ClientSecurity {
    /// Key pair of the client.
    pub pair: KeyPair,
    /// Public key of the server.
    pub server: PublicKey,
}

impl ClientSecurity {
    /// Combines this key pair with the public key of the server.
    #[must_use]
    pub fn new(pair: KeyPair, server: PublicKey) -> Self {
        Self { pair, server }
    }

    /// Reads a secret key file and the server's public key file.
    ///
    /// # Errors
    /// Same as [`KeyPair::read`] and [`PublicKey::read`].
    pub fn read(key: &Path, server_key: &Path) -> Result<Self, SecurityError> {
        Ok(Self { pair: KeyPair::read(key)?, server: PublicKey::read(server_key)? })
    }

    /// Returns the mechanism with these keys.
    pub(crate) fn mechanism(&self) -> MechanismSetup {
        MechanismSetup::CurveClient {
            our_keypair: self.pair.for_curve(),
            server_public: CurvePublicKey::from_bytes(*self.server.bytes()),
        }
    }
}
