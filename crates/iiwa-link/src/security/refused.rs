//! Why a connection does not come about.

/// Why the other side does not admit this one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refused {
    /// The server does not know the key.
    NotAllowed,
    /// One side has keys and the other one does not.
    KeysOnOneSide,
    /// The server hung up during the handshake. So it does if the client has the wrong server key or keys
    /// that do not belong together, but also if it just ends.
    HungUp,
}

impl Refused {
    /// What it means for the client, in words.
    #[must_use]
    pub fn what(self) -> &'static str {
        match self {
            Self::NotAllowed => "its key is not on the drive's list",
            Self::KeysOnOneSide => "one side has keys and the other one has none",
            Self::HungUp => "the drive hung up; is the drive's public key the right one?",
        }
    }
}
