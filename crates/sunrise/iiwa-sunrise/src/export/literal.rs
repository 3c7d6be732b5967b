//! Java literals.

use std::fmt::Write as _;

/// Formats a number that Java reads back bit for bit.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// Formats an angle in rad: in degrees if a short number of degrees converts to the same bits, as
/// `Math.toRadians` of Java 9 and Rust do.
pub(super) fn angle(rad: f64) -> String {
    match short_degrees(rad) {
        Some(deg) if deg != 0.0 => format!("Math.toRadians({})", number(deg)),
        _ => number(rad),
    }
}

/// Returns the number of degrees that converts to the same bits, or the nearest one.
pub(super) fn degrees(rad: f64) -> f64 {
    let about = rad.to_degrees();
    let near = [about, about.next_up(), about.next_down()];
    let exact = || near.into_iter().find(|deg| deg.to_radians() == rad);
    short_degrees(rad).or_else(exact).unwrap_or(about)
}

/// Returns the shortest number of degrees, with at most six decimals as people type them, that
/// converts to the same bits.
fn short_degrees(rad: f64) -> Option<f64> {
    const MAX_DECIMALS: i32 = 6;
    let deg = rad.to_degrees();
    (0..=MAX_DECIMALS)
        .map(|decimals| {
            let scale = 10_f64.powi(decimals);
            (deg * scale).round() / scale
        })
        .find(|deg| deg.to_radians() == rad)
}

/// Formats a length in m, or a derivative in m/s^n, in mm: the number that a reader of programs
/// converts to the same bits, if one exists.
pub(super) fn millimetres(metres: f64) -> String {
    let about = 1e3 * metres;
    let near = [about, about.next_up(), about.next_down()];
    number(near.into_iter().find(|mm| 1e-3 * mm == metres).unwrap_or(about))
}

/// Formats a string in ASCII characters, which every file encoding has.
pub(super) fn text(text: &str) -> String {
    let mut literal = "\"".to_owned();
    for unit in text.encode_utf16() {
        match unit {
            0x22 | 0x5c => literal.extend(['\\', char::from(unit.to_le_bytes()[0])]),
            0x20..=0x7e => literal.push(char::from(unit.to_le_bytes()[0])),
            0x09 => literal.push_str("\\t"),
            0x0a => literal.push_str("\\n"),
            0x0d => literal.push_str("\\r"),
            _ => {
                let _ = write!(literal, "\\u{unit:04x}");
            }
        }
    }
    literal.push('"');
    literal
}

/// Formats a text within a comment, in UTF-8: without the end of the comment, without escapes,
/// which Java processes even in comments, and without characters that control lines or the
/// direction of text. In a file that is read in another encoding, comments only look different.
pub(super) fn comment(text: &str) -> String {
    let plain = |c: char| match c {
        '\\' => '/',
        '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}' => '?',
        c if c.is_control() => '?',
        c => c,
    };
    let text = text.chars().map(plain).collect::<String>().replace("*/", "* /");
    // An import would read it as a part of the next statement's label.
    if text.starts_with("iiwasim ") { format!("- {text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_in_degrees_where_these_are_the_same_bits() {
        for deg in [-170.0, -27.5, 0.125, 42.0, 87.8, 90.0, 114.0] {
            assert_eq!(angle(f64::to_radians(deg)), format!("Math.toRadians({deg:?})"));
        }
        assert_eq!(angle(-0.337_023), "-0.337023");
        assert_eq!(angle(0.0), "0.0");
        assert_eq!(angle(-0.0), "-0.0");
        // One bit off.
        let near = 30_f64.to_radians().next_up();
        assert_eq!(angle(near).parse(), Ok(near));
    }

    #[test]
    fn strings_have_no_characters_that_an_encoding_may_lack() {
        assert_eq!(text("Käfig \"2\"\\\n"), r#""K\u00e4fig \"2\"\\\n""#);
        assert_eq!(text("\u{1f916}"), r#""\ud83e\udd16""#);
        assert_eq!(comment("a\\u002a/ */ Glühofen 溶接\r"), "a/u002a/ * / Glühofen 溶接?");
        assert_eq!(comment("a\u{202e}b"), "a?b");
    }

    #[test]
    fn lengths_are_read_back() {
        for mm in [0.1, 0.3, 17.0, 250.0, 1234.567] {
            let metres = 1e-3 * mm;
            let written: f64 = millimetres(metres).parse().unwrap();
            assert_eq!(1e-3 * written, metres);
        }
    }
}
