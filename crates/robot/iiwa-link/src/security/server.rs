//! Server security.

use std::{
    path::Path,
    sync::{Mutex, PoisonError},
};

use omq_proto::{
    AuthenticationResult, Authenticator, CurveServerOptions, MechanismPeerInfo, MechanismSetup,
};

use super::{
    allow::AllowList,
    error::SecurityError,
    key::{KeyPair, PublicKey},
    refusal_log::RefusalLog,
};

/// Key pair of a server, and its permitted clients.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ServerSecurity {
    /// Key pair of the server.
    pub pair: KeyPair,
    /// The permitted clients.
    pub allowed: AllowList,
}

impl ServerSecurity {
    /// Combines this key pair with a list of permitted clients.
    #[must_use]
    pub fn new(pair: KeyPair, allowed: AllowList) -> Self {
        Self { pair, allowed }
    }

    /// Reads a secret key file, and the clients' public keys from a file or a folder.
    ///
    /// # Errors
    /// Same as [`KeyPair::read`] and [`AllowList::read`].
    pub fn read(key: &Path, allow: &Path) -> Result<Self, SecurityError> {
        Ok(Self { pair: KeyPair::read(key)?, allowed: AllowList::read(allow)? })
    }

    /// Returns the mechanism that accepts clients with a key on the list, under the name of this
    /// key. Refused clients are logged as warnings.
    pub(crate) fn mechanism(&self) -> MechanismSetup {
        let allowed = self.allowed.clone();
        let refusals = Mutex::new(RefusalLog::default());
        let check = move |peer: &MechanismPeerInfo| {
            let key = PublicKey::from(peer.public_key);
            let address = peer.peer_address.as_deref().unwrap_or_default();
            if let Some(name) = allowed.name(&key) {
                tracing::info!(client = name, address, "admitted");
                // Connection slots are counted by this name.
                return AuthenticationResult::allow().with_user_id(name.as_bytes().to_vec());
            }
            // Each attempt has another port.
            let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
            // The log remains usable after a panic: it only limits the rate of messages.
            let mut refusals = refusals.lock().unwrap_or_else(PoisonError::into_inner);
            if refusals.record(host, Some(key)) {
                tracing::warn!(address, key = %key, "refused: its key is not allowed");
            }
            AuthenticationResult::deny()
        };
        let mut options = CurveServerOptions::new();
        options.authenticator = Some(Authenticator::new_with_result(check));
        MechanismSetup::CurveServer { our_keypair: self.pair.for_curve(), options }
    }
}
