//! Reasons of refused connections.

/// Reason why the other side refuses a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ConnectionRefusal {
    /// The server does not know the key.
    NotAllowed,
    /// Only one of the two sides has keys.
    KeysOnOneSide,
    /// The server closed the connection during the handshake: the client has the wrong server key
    /// or a key pair that does not match, or the server is shutting down.
    Closed,
}

impl ConnectionRefusal {
    /// Returns the reason as text, for the client.
    #[must_use]
    pub fn reason(self) -> &'static str {
        match self {
            Self::NotAllowed => "the client's key is not on the drive's list",
            Self::KeysOnOneSide => {
                "one side has keys and the other one has none: both need them, or neither"
            }
            Self::Closed => {
                "the drive closed the connection; is the drive's public key the right one?"
            }
        }
    }
}
