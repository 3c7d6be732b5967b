//! Long lists of numbers as text.

use serde::Serialize;

/// Numbers in base64 (RFC 4648) of their bytes, little-endian: a third of what they take in decimals.
#[derive(Debug, Default, Serialize)]
#[serde(transparent)]
pub(crate) struct Packed(String);

impl Packed {
    /// Times and other numbers that need all their digits.
    pub(crate) fn doubles(values: impl IntoIterator<Item = f64>) -> Self {
        Self(base64(values.into_iter().flat_map(f64::to_le_bytes)))
    }

    /// Numbers that are drawn: seven digits.
    #[expect(clippy::cast_possible_truncation, reason = "finer than any screen")]
    pub(crate) fn singles(values: impl IntoIterator<Item = f64>) -> Self {
        Self(base64(values.into_iter().flat_map(|value| (value as f32).to_le_bytes())))
    }
}

fn base64(bytes: impl IntoIterator<Item = u8>) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut bytes = bytes.into_iter();
    let mut text = String::new();
    while let Some(first) = bytes.next() {
        let rest = [bytes.next(), bytes.next()];
        let three = [first, rest[0].unwrap_or(0), rest[1].unwrap_or(0)];
        let bits = three.iter().fold(0_usize, |bits, byte| bits << 8 | usize::from(*byte));
        let digits = 2 + rest.iter().flatten().count();
        for place in 0..4 {
            let digit = DIGITS[bits >> (18 - 6 * place) & 63];
            text.push(if place < digits { char::from(digit) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::base64;

    #[test]
    fn vectors_of_the_standard() {
        // RFC 4648, section 10.
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(bytes.bytes()), text);
        }
        assert_eq!(base64([0xff, 0xfe, 0xfb]), "//77");
    }
}
