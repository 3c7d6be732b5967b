//! What a server needs to check its clients.

use std::path::Path;

use super::{AllowList, KeyPair, SecurityError};

/// A server's own keys and the clients that it lets in. [`Authenticator`](super::Authenticator)
/// puts it to work.
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
    /// As [`KeyPair::read`] and [`AllowList::read`]; the libzmq of this build has no CURVE.
    pub fn read(key: &Path, allow: &Path) -> Result<Self, SecurityError> {
        super::require_curve()?;
        Ok(Self { pair: KeyPair::read(key)?, allowed: AllowList::read(allow)? })
    }
}
