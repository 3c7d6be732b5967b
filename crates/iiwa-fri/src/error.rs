//! What can be wrong with a datagram.

use super::MAX_DATAGRAM_BYTES;

/// Why a datagram is no message. Fields go by their names on the wire.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WireError {
    /// More bytes than a datagram of the FRI holds.
    #[error("a datagram of {found} bytes, expected at most {MAX_DATAGRAM_BYTES}")]
    TooLong {
        /// The length of the datagram.
        found: usize,
    },
    /// Bytes that are no such message.
    #[error("the datagram does not decode")]
    Decode {
        /// What the decoder says.
        #[source]
        source: prost::DecodeError,
    },
    /// A message of another kind, or of another version.
    #[error("message identifier {found:#x}, expected {expected:#x}")]
    Identifier {
        /// The identifier of the message asked for.
        expected: u32,
        /// The identifier in the datagram.
        found: u32,
    },
    /// A field that the message cannot do without.
    #[error("`{field}` is missing")]
    Missing {
        /// The field.
        field: &'static str,
    },
    /// A number that stands for nothing.
    #[error("`{field}` is {found}, which has no meaning")]
    UnknownValue {
        /// The field.
        field: &'static str,
        /// The number in it.
        found: i32,
    },
    /// A list that does not have one value a joint.
    #[error("{found} values in `{field}`, expected 7")]
    JointCount {
        /// The field.
        field: &'static str,
        /// How many values it has.
        found: usize,
    },
    /// An infinite value, or none at all.
    #[error("a value of `{field}` is not a finite number")]
    NotFinite {
        /// The field.
        field: &'static str,
    },
    /// A controller that wants no answers, ever.
    #[error("`connectionInfo.receiveMultiplier` is 0, expected at least 1")]
    ReceiveMultiplier,
}

impl From<prost::DecodeError> for WireError {
    fn from(source: prost::DecodeError) -> Self {
        Self::Decode { source }
    }
}
