//! What a server needs to check its clients.

use std::{
    path::Path,
    sync::{Mutex, PoisonError},
};

use omq_proto::{
    AuthenticationResult, Authenticator, CurveServerOptions, MechanismPeerInfo, MechanismSetup,
};

use super::{AllowList, KeyPair, PublicKey, SecurityError, refusals::Refusals};

/// A server's own keys and the clients that it lets in.
#[derive(Clone, Debug)]
pub struct ServerSecurity {
    /// Its keys.
    pub pair: KeyPair,
    /// Its clients.
    pub allowed: AllowList,
}

impl ServerSecurity {
    /// Reads a file with a secret key, and the clients' public keys: a file or a folder of them.
    ///
    /// # Errors
    /// As [`KeyPair::read`] and [`AllowList::read`].
    pub fn read(key: &Path, allow: &Path) -> Result<Self, SecurityError> {
        Ok(Self { pair: KeyPair::read(key)?, allowed: AllowList::read(allow)? })
    }

    /// How clients are checked: those with a key on the list are let in, under its name; all others get
    /// nothing. Clients that are refused are named in warnings.
    pub(crate) fn mechanism(&self) -> MechanismSetup {
        let allowed = self.allowed.clone();
        let refusals = Mutex::new(Refusals::default());
        let check = move |peer: &MechanismPeerInfo| {
            let key = PublicKey::from(peer.public_key);
            let address = peer.peer_address.as_deref().unwrap_or_default();
            if let Some(name) = allowed.name(&key) {
                tracing::info!(client = name, address, "admitted");
                return AuthenticationResult::allow().with_user_id(name.as_bytes().to_vec());
            }
            // Each attempt comes from another port.
            let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
            let mut refusals = refusals.lock().unwrap_or_else(PoisonError::into_inner);
            if refusals.is_news(host, Some(key)) {
                tracing::warn!(address, key = %key, "refused: its key is not allowed");
            }
            AuthenticationResult::deny()
        };
        let mut options = CurveServerOptions::new();
        options.authenticator = Some(Authenticator::new_with_result(check));
        MechanismSetup::CurveServer { our_keypair: self.pair.for_curve(), options }
    }
}
