//! Decoding errors.

use crate::message::MAX_DATAGRAM_BYTES;

/// Reason why a datagram cannot be decoded. Fields have their names on the wire.
///
/// ```
/// use iiwa_fri::{Format, WireError};
///
/// let error = Format::V1.decode_command(&[0; 2000]).unwrap_err();
/// assert_eq!(error, WireError::TooLong { found: 2000 });
/// assert_eq!(error.to_string(), "datagram of 2000 bytes, expected at most 1500");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WireError {
    /// The datagram is longer than [`MAX_DATAGRAM_BYTES`].
    #[error("datagram of {found} bytes, expected at most {MAX_DATAGRAM_BYTES}")]
    TooLong {
        /// Length of the datagram, in bytes.
        found: usize,
    },
    /// The bytes are not valid protobuf.
    #[error("the datagram is not valid protobuf")]
    Decode {
        /// Error of the decoder.
        #[source]
        source: prost::DecodeError,
    },
    /// A message of another kind or version.
    #[error("message identifier {found:#x}, expected {expected:#x}")]
    Identifier {
        /// Expected message identifier.
        expected: u32,
        /// Message identifier in the datagram.
        found: u32,
    },
    /// A required field is missing.
    #[error("`{field}` is missing")]
    Missing {
        /// The field.
        field: &'static str,
    },
    /// An enum field with a number outside its range.
    #[error("unknown value {found} in `{field}`")]
    UnknownValue {
        /// The field.
        field: &'static str,
        /// Value of the field.
        found: i32,
    },
    /// A list that does not have one value per joint.
    #[error("{found} values in `{field}`, expected 7")]
    JointCount {
        /// The field.
        field: &'static str,
        /// Number of values.
        found: usize,
    },
    /// A value that is not finite.
    #[error("`{field}` contains a value that is not finite")]
    NotFinite {
        /// The field.
        field: &'static str,
    },
    /// A receive multiplier of 0.
    #[error("`connectionInfo.receiveMultiplier` is 0, expected at least 1")]
    ReceiveMultiplier,
}

impl From<prost::DecodeError> for WireError {
    fn from(source: prost::DecodeError) -> Self {
        Self::Decode { source }
    }
}
