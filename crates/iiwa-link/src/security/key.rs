//! Keys, and whether this build can use them.

use std::{fmt, str::FromStr};

use super::{KeyTextError, SecurityError, z85};

/// Whether the libzmq of this build has CURVE.
#[must_use]
pub fn has_curve() -> bool {
    zmq::has("curve") == Some(true)
}

/// Fails if the libzmq of this build has no CURVE.
///
/// # Errors
/// [`SecurityError::NoCurve`].
pub fn require_curve() -> Result<(), SecurityError> {
    if has_curve() {
        return Ok(());
    }
    let (major, minor, patch) = zmq::version();
    Err(SecurityError::NoCurve { version: format!("{major}.{minor}.{patch}") })
}

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
    /// [`SecurityError::NoCurve`] if the libzmq of this build has none; libzmq finds no randomness.
    pub fn generate() -> Result<Self, SecurityError> {
        require_curve()?;
        let pair = zmq::CurveKeyPair::new().map_err(SecurityError::zmq("make keys"))?;
        Ok(Self { public: PublicKey(pair.public_key), secret: pair.secret_key })
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
}

impl fmt::Debug for KeyPair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KeyPair").field("public", &self.public).finish_non_exhaustive()
    }
}
