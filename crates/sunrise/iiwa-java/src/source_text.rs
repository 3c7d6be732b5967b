//! Decodes the bytes of a source file.

use std::char::{REPLACEMENT_CHARACTER, decode_utf16};

/// Characters of the bytes 0x80 to 0x9F in code page 1252, as the WHATWG encoding standard defines
/// them; all other bytes are the characters with these numbers.
const OF_CODE_PAGE: &str = "\
    \u{20ac}\u{81}\u{201a}\u{192}\u{201e}\u{2026}\u{2020}\u{2021}\
    \u{2c6}\u{2030}\u{160}\u{2039}\u{152}\u{8d}\u{17d}\u{8f}\
    \u{90}\u{2018}\u{2019}\u{201c}\u{201d}\u{2022}\u{2013}\u{2014}\
    \u{2dc}\u{2122}\u{161}\u{203a}\u{153}\u{9d}\u{17e}\u{178}";

/// Decodes a file to a text with `\n` or `\r\n` line ends.
///
/// A byte order mark selects UTF-8 or UTF-16. Without one, the file is UTF-8 if valid; otherwise
/// Windows code page 1252, in which Sunrise Workbench saves.
#[must_use]
pub fn decode(bytes: &[u8]) -> String {
    let text = match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => String::from_utf8_lossy(rest).into_owned(),
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => bytes.iter().map(|byte| of_code_page(*byte)).collect(),
        },
    };
    // Java also accepts a single `\r` as a line end.
    let mut lines = text.split("\r\n");
    if lines.any(|line| line.contains('\r')) {
        return text
            .split("\r\n")
            .map(|line| line.replace('\r', "\n"))
            .collect::<Vec<_>>()
            .join("\r\n");
    }
    text
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let (pairs, half) = bytes.as_chunks();
    let text = decode_utf16(pairs.iter().copied().map(unit));
    let text = text.map(|read| read.unwrap_or(REPLACEMENT_CHARACTER));
    text.chain(half.iter().map(|_| REPLACEMENT_CHARACTER)).collect()
}

fn of_code_page(byte: u8) -> char {
    let place = byte.checked_sub(0x80).map(usize::from);
    place.and_then(|place| OF_CODE_PAGE.chars().nth(place)).unwrap_or(char::from(byte))
}

#[cfg(test)]
mod tests {
    use super::decode;

    #[test]
    fn code_page_1252() {
        assert_eq!(decode(b"\x80 \x93Gr\xfc\xdfe\x94 \x96 20\xb0 \x9f\x99"), "€ “Grüße” – 20° Ÿ™");
        // Undefined bytes of the code page.
        assert_eq!(decode(b"\x81\x8d\x8f\x90\x9d"), "\u{81}\u{8d}\u{8f}\u{90}\u{9d}");
        let high: Vec<u8> = (0xa0..=0xff).collect();
        assert!(decode(&high).chars().eq('\u{a0}'..='\u{ff}'));
    }

    #[test]
    fn marks() {
        for (bytes, text) in [
            (&b"\xef\xbb\xbfa\xc3\xbc\xff"[..], "aü\u{fffd}"),
            (b"\xff\xfea\0\xfc\0", "aü"),
            (b"\xfe\xff\0a\0\xfc\0", "aü\u{fffd}"),
            (b"\xfe\xff\xd8\x3d\xde\x00\xd8\x3d", "😀\u{fffd}"),
            (b"a\xc3\xbc", "aü"),
            (b"", ""),
        ] {
            assert_eq!(decode(bytes), text, "{bytes:?}");
        }
    }
}
