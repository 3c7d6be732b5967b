//! Messages as bytes.

use super::{Command, Monitoring, WireError, v1};

/// The longest datagram, in bytes.
pub const MAX_DATAGRAM_BYTES: usize = 1500;

/// A version of the messages' bytes. The sessions know none of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// FRI 1.14, 1.15 and 1.16, which share one.
    #[default]
    V1,
}

impl Format {
    /// Writes a message of the controller in place of what `out` holds.
    pub fn encode_monitoring(self, message: &Monitoring, out: &mut Vec<u8>) {
        out.clear();
        match self {
            Self::V1 => v1::encode_monitoring(message, out),
        }
    }

    /// Reads a message of the controller. What [`Monitoring`] has no place for (inputs and outputs,
    /// transformations) is passed over.
    ///
    /// # Errors
    ///
    /// When the datagram is none; see [`WireError`].
    pub fn decode_monitoring(self, datagram: &[u8]) -> Result<Monitoring, WireError> {
        short(datagram)?;
        match self {
            Self::V1 => v1::decode_monitoring(datagram),
        }
    }

    /// Writes an answer of the client in place of what `out` holds.
    pub fn encode_command(self, message: &Command, out: &mut Vec<u8>) {
        out.clear();
        match self {
            Self::V1 => v1::encode_command(message, out),
        }
    }

    /// Reads an answer of the client. What [`Command`] has no place for (wrenches, torques,
    /// outputs, transformations) is passed over.
    ///
    /// # Errors
    ///
    /// When the datagram is none; see [`WireError`].
    pub fn decode_command(self, datagram: &[u8]) -> Result<Command, WireError> {
        short(datagram)?;
        match self {
            Self::V1 => v1::decode_command(datagram),
        }
    }
}

/// Refuses datagrams that no side may send, before any of their bytes is looked at.
fn short(datagram: &[u8]) -> Result<(), WireError> {
    if datagram.len() > MAX_DATAGRAM_BYTES {
        return Err(WireError::TooLong { found: datagram.len() });
    }
    Ok(())
}
