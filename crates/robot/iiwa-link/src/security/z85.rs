//! Z85 (`ZeroMQ` RFC 32): 4 bytes as 5 printable characters. Unlike libzmq's decoder, this decoder
//! refuses other characters.

use super::error::KeyTextError;

const DIGITS: &[u8; 85] =
    b"0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?&<>()[]{}@%$#";

/// Encodes a key as 40 characters.
pub(super) fn encode(key: &[u8; 32]) -> String {
    let mut text = String::with_capacity(40);
    for word in key.chunks_exact(4) {
        let value = word.iter().fold(0, |value, byte| (value << 8) | u32::from(*byte));
        for power in [52_200_625, 614_125, 7_225, 85, 1] {
            text.push(char::from(DIGITS[(value / power % 85) as usize]));
        }
    }
    text
}

/// Decodes a key of 40 characters.
///
/// # Errors
/// A wrong number of characters, a character that is not one of the 85, or a group out of range.
pub(super) fn decode(text: &str) -> Result<[u8; 32], KeyTextError> {
    let found = text.chars().count();
    if found != 40 {
        return Err(KeyTextError::Length { found });
    }
    let mut key = [0; 32];
    // 64 bits, because five digits may exceed 32: 85^5 > 2^32.
    let (mut value, mut words) = (0_u64, key.chunks_exact_mut(4));
    for (i, character) in text.chars().enumerate() {
        let digit = DIGITS.iter().position(|digit| char::from(*digit) == character);
        let digit = digit.ok_or(KeyTextError::Character { position: i + 1, character })?;
        value = value * 85 + digit as u64;
        if i % 5 == 4 {
            let word =
                u32::try_from(value).map_err(|_| KeyTextError::TooLarge { position: i - 3 })?;
            if let Some(bytes) = words.next() {
                bytes.copy_from_slice(&word.to_be_bytes());
            }
            value = 0;
        }
    }
    Ok(key)
}
