//! From the bytes of a source file to its text.

use encoding_rs::{Encoding, WINDOWS_1252};

/// The text of a file, whose lines end with `\n` or `\r\n`.
///
/// A byte order mark says that it is in UTF-8 or UTF-16. Without one, it is in UTF-8 if it can be; else in the code page
/// of western Europe's Windows, which Sunrise Workbench saves in.
#[must_use]
pub fn decode(bytes: &[u8]) -> String {
    let text = match (Encoding::for_bom(bytes), std::str::from_utf8(bytes)) {
        (Some((encoding, mark)), _) => {
            encoding.decode_without_bom_handling(bytes.get(mark..).unwrap_or_default()).0
        }
        (None, Ok(text)) => text.into(),
        (None, Err(_)) => WINDOWS_1252.decode_without_bom_handling(bytes).0,
    };
    // Where `\r` alone ends lines, as Java lets it.
    let mut lines = text.split("\r\n");
    if lines.any(|line| line.contains('\r')) {
        return text
            .split("\r\n")
            .map(|line| line.replace('\r', "\n"))
            .collect::<Vec<_>>()
            .join("\r\n");
    }
    text.into_owned()
}
