//! CURVE keys.

use std::{fmt, str::FromStr};

use omq_proto::{CurveKeypair, CurvePublicKey, CurveSecretKey};

use super::{
    error::{KeyTextError, SecurityError},
    z85,
};

/// A public key of 32 bytes; as text, 40 characters of Z85.
///
/// ```
/// use iiwa_link::security::PublicKey;
///
/// let key: PublicKey = "rq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7".parse()?;
/// assert_eq!(key.to_string().len(), 40);
/// assert!("too short".parse::<PublicKey>().is_err());
/// # Ok::<(), iiwa_link::security::KeyTextError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PublicKey([u8; 32]);

impl PublicKey {
    /// Returns the bytes.
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

/// A secret key with its public key. `Debug` does not print the secret.
///
/// ```
/// use iiwa_link::security::{KeyPair, PublicKey};
///
/// let folder = tempfile::tempdir()?;
/// let pair = KeyPair::generate()?;
/// let (secret, public) = pair.write(folder.path(), "alice")?;
/// assert_eq!(KeyPair::read(&secret)?.public(), pair.public());
/// assert_eq!(PublicKey::read(&public)?, pair.public());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct KeyPair {
    public: PublicKey,
    secret: [u8; 32],
}

impl KeyPair {
    /// Generates a pair.
    ///
    /// # Errors
    /// The system's random number generator fails.
    pub fn generate() -> Result<Self, SecurityError> {
        let mut secret = [0; 32];
        getrandom::fill(&mut secret).map_err(|source| SecurityError::Random { source })?;
        let public = CurveSecretKey::from_bytes(secret).derive_public();
        Ok(Self { public: PublicKey(*public.as_bytes()), secret })
    }

    /// Creates a pair from a key file. A mismatch of the two keys fails in the handshake.
    pub(super) fn new(public: PublicKey, secret: [u8; 32]) -> Self {
        Self { public, secret }
    }

    /// Returns the public key.
    #[must_use]
    pub fn public(&self) -> PublicKey {
        self.public
    }

    pub(super) fn secret(&self) -> &[u8; 32] {
        &self.secret
    }

    /// Returns the pair as a type of `omq-proto`.
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
