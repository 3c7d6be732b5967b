//! Keys.

use std::{fmt, str::FromStr};

use omq_proto::{CurveKeypair, CurvePublicKey, CurveSecretKey};

use super::{KeyTextError, SecurityError, z85};

/// A public key; as text, 40 characters of Z85.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PublicKey([u8; 32]);

impl PublicKey {
    /// Its bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

impl From<[u8; 32]> for PublicKey {
    fn from(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }
}

impl fmt::Display for PublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&z85::encode(&self.0))
    }
}

impl fmt::Debug for PublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "PublicKey({self})")
    }
}

impl FromStr for PublicKey {
    type Err = KeyTextError;

    fn from_str(text: &str) -> Result<Self, KeyTextError> {
        z85::decode(text).map(Self)
    }
}

/// A secret key with its public key. Printing it does not show the secret.
#[derive(Clone)]
pub struct KeyPair {
    public: PublicKey,
    secret: [u8; 32],
}

impl KeyPair {
    /// A new pair.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn generate() -> Result<Self, SecurityError> {
        let mut secret = [0; 32];
        getrandom::fill(&mut secret).map_err(|source| SecurityError::Random { source })?;
        let public = CurveSecretKey::from_bytes(secret).derive_public();
        Ok(Self { public: PublicKey(*public.as_bytes()), secret })
    }

    /// A pair of a key file. Whether the two belong together shows when they are used.
    pub(super) fn new(public: PublicKey, secret: [u8; 32]) -> Self {
        Self { public, secret }
    }

    /// The public key.
    #[must_use]
    pub fn public(&self) -> PublicKey {
        self.public
    }

    pub(super) fn secret(&self) -> &[u8; 32] {
        &self.secret
    }

    /// As the protocol takes it.
    pub(super) fn for_curve(&self) -> CurveKeypair {
        CurveKeypair {
            public: CurvePublicKey::from_bytes(self.public.0),
            secret: CurveSecretKey::from_bytes(self.secret),
        }
    }
}

impl fmt::Debug for KeyPair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KeyPair").field("public", &self.public).finish_non_exhaustive()
    }
}
