//! CDR bodies behind the four-byte encapsulation header of ROS 2.

use byteorder::LittleEndian;
use serde::{Deserialize, Serialize};

/// Representation `CDR_LE` and two option bytes (DDSI-RTPS 2.3, section 10.5).
pub(crate) const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Some writers pad the last word of a body; more bytes indicate another type.
const MAX_PADDING: usize = 7;

/// Replaces the content of `buffer` with the encoded message.
pub(crate) fn encode<T: Serialize>(
    buffer: &mut Vec<u8>,
    message: &T,
) -> Result<(), cdr_encoding::Error> {
    buffer.clear();
    buffer.extend_from_slice(&ENCAPSULATION);
    append(buffer, message)
}

/// Appends `message` as if a body began here: alignment counts from the first appended byte.
pub(crate) fn append<T: Serialize>(
    buffer: &mut Vec<u8>,
    message: &T,
) -> Result<(), cdr_encoding::Error> {
    cdr_encoding::to_writer::<_, LittleEndian, _>(buffer, message)
}

/// Decodes a whole message. The error describes the mismatch, without its position in the file.
pub(crate) fn decode<'de, T: Deserialize<'de>>(bytes: &'de [u8]) -> Result<T, String> {
    let Some((head, body)) = bytes.split_first_chunk::<4>() else {
        return Err(format!("{} bytes cannot hold an encapsulation header", bytes.len()));
    };
    if head[..2] != ENCAPSULATION[..2] {
        return Err(format!(
            "representation {:02x} {:02x} instead of 00 01 (CDR, little-endian)",
            head[0], head[1]
        ));
    }
    let (message, consumed) = cdr_encoding::from_bytes::<T, LittleEndian>(body)
        .map_err(|error| format!("{error} in {} bytes", bytes.len()))?;
    let remaining = body.len() - consumed;
    if remaining > MAX_PADDING {
        return Err(format!("{remaining} bytes left over after the last field"));
    }
    Ok(message)
}
