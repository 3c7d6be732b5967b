//! Wire formats.

use crate::{
    error::WireError,
    message::{Command, MAX_DATAGRAM_BYTES, Monitoring},
    v1,
};

/// Wire format of the messages. Sessions are independent of the format.
///
/// ```
/// use iiwa_fri::{Command, Format, Monitoring, WireError};
///
/// let mut datagram = Vec::new();
/// Format::V1.encode_monitoring(&Monitoring::default(), &mut datagram);
/// // A monitoring message is not a command message.
/// let error = Format::V1.decode_command(&datagram).unwrap_err();
/// assert!(matches!(error, WireError::Identifier { .. }));
///
/// Format::V1.encode_command(&Command::default(), &mut datagram);
/// assert_eq!(Format::V1.decode_command(&datagram)?, Command::default());
/// # Ok::<(), WireError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// FRI 1.14, 1.15 and 1.16.
    #[default]
    V1,
}

impl Format {
    /// Encodes a monitoring message into `out`, whose content is replaced.
    pub fn encode_monitoring(self, message: &Monitoring, out: &mut Vec<u8>) {
        out.clear();
        match self {
            Self::V1 => v1::encode_monitoring(message, out),
        }
    }

    /// Decodes a monitoring message. Fields that [`Monitoring`] does not model (inputs and outputs,
    /// transformations) are ignored.
    ///
    /// # Errors
    ///
    /// Any [`WireError`].
    pub fn decode_monitoring(self, datagram: &[u8]) -> Result<Monitoring, WireError> {
        check_length(datagram)?;
        match self {
            Self::V1 => v1::decode_monitoring(datagram),
        }
    }

    /// Encodes a command message into `out`, whose content is replaced.
    pub fn encode_command(self, message: &Command, out: &mut Vec<u8>) {
        out.clear();
        match self {
            Self::V1 => v1::encode_command(message, out),
        }
    }

    /// Decodes a command message. Fields that [`Command`] does not model (wrenches, torques,
    /// outputs, transformations) are ignored.
    ///
    /// # Errors
    ///
    /// Any [`WireError`].
    pub fn decode_command(self, datagram: &[u8]) -> Result<Command, WireError> {
        check_length(datagram)?;
        match self {
            Self::V1 => v1::decode_command(datagram),
        }
    }
}

/// Refuses overlong datagrams before any of their bytes is decoded.
fn check_length(datagram: &[u8]) -> Result<(), WireError> {
    if datagram.len() > MAX_DATAGRAM_BYTES {
        return Err(WireError::TooLong { found: datagram.len() });
    }
    Ok(())
}
