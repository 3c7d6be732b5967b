//! What a client needs to be let in, and to know that the server is the right one.

use std::path::Path;

use omq_proto::{CurvePublicKey, MechanismSetup};

use super::{KeyPair, PublicKey, SecurityError};

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
    /// As [`KeyPair::read`] and [`PublicKey::read`].
    pub fn read(key: &Path, server_key: &Path) -> Result<Self, SecurityError> {
        Ok(Self { pair: KeyPair::read(key)?, server: PublicKey::read(server_key)? })
    }

    /// How the keys are shown.
    pub(crate) fn mechanism(&self) -> MechanismSetup {
        MechanismSetup::CurveClient {
            our_keypair: self.pair.for_curve(),
            server_public: CurvePublicKey::from_bytes(*self.server.bytes()),
        }
    }
}
