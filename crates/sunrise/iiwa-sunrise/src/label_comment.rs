//! Names, comments and groups of motions in Java sources: comment lines directly before a
//! statement, which the export writes and the import reads.
//!
//! ```java
//! // iiwasim name: approach
//! // iiwasim comment: 20 mm above the part
//! // iiwasim comment: with the gripper open
//! // iiwasim group: pick
//! lbr.move(ptp(...));
//! ```
//!
//! Each line of a comment is a line of its own. Backslashes, control characters, marks that change
//! the direction of text, and a space at the end of a line are Java's Unicode escapes, `\u005c`.
//! All other comments are left to the programmer.

use std::fmt::Write as _;

use iiwa_program::MotionLabel;

/// Beginning of the comment lines.
const MARK: &str = "// iiwasim ";

/// Keys of the lines.
const NAME: &str = "name";
const COMMENT: &str = "comment";
const GROUP: &str = "group";

/// Formats a label as comment lines without indentation.
pub(crate) fn label_lines(label: &MotionLabel) -> Vec<String> {
    let MotionLabel { name, comment, group } = label;
    let line = |key: &str, text: &str| match encoded(text) {
        text if text.is_empty() => format!("{MARK}{key}:"),
        text => format!("{MARK}{key}: {text}"),
    };
    let mut lines: Vec<String> = name.iter().map(|name| line(NAME, name)).collect();
    if let Some(comment) = comment {
        let comment = comment.replace("\r\n", "\n");
        lines.extend(comment.split(['\n', '\r']).map(|text| line(COMMENT, text)));
    }
    lines.extend(group.iter().map(|group| line(GROUP, group)));
    lines
}

/// Returns the labels of a Java source, by the numbers of the lines that follow their comment
/// lines; other line comments may be in between.
pub(crate) fn stated_labels(text: &str) -> Vec<(u32, MotionLabel)> {
    let mut labels = Vec::new();
    let mut label = MotionLabel::default();
    for (number, line) in (1..).zip(text.lines()) {
        match key_and_text(line) {
            Some((NAME, name)) => label.name = Some(name),
            Some((GROUP, group)) => label.group = Some(group),
            Some((_, comment)) => match &mut label.comment {
                Some(before) => {
                    before.push('\n');
                    before.push_str(&comment);
                }
                none => *none = Some(comment),
            },
            // A comment may have been wrapped, or stand between the label and its statement.
            None if !label.is_empty() && line.trim_start().starts_with("//") => {}
            None if !label.is_empty() => labels.push((number, std::mem::take(&mut label))),
            None => {}
        }
    }
    labels
}

/// Key and text of a comment line with a part of a label.
fn key_and_text(line: &str) -> Option<(&'static str, String)> {
    let (key, text) = line.trim().strip_prefix(MARK)?.split_once(':')?;
    let key = [NAME, COMMENT, GROUP].into_iter().find(|known| *known == key)?;
    Some((key, decoded(text.strip_prefix(' ').unwrap_or(text))))
}

/// Returns true for characters that could end a comment line, or show it other than it is.
fn is_escaped(c: char) -> bool {
    c == '\\'
        || c.is_control()
        || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

fn encoded(text: &str) -> String {
    let end = text.trim_end().len();
    let mut encoded = String::with_capacity(text.len());
    for (offset, c) in text.char_indices() {
        if is_escaped(c) || offset >= end {
            let _ = write!(encoded, "\\u{:04x}", u32::from(c));
        } else {
            encoded.push(c);
        }
    }
    encoded
}

fn decoded(text: &str) -> String {
    let mut decoded = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('\\') {
        decoded.push_str(before);
        let digits = after.trim_start_matches('u');
        let code = digits.get(..4).filter(|_| digits.len() < after.len());
        let code = code.and_then(|digits| u32::from_str_radix(digits, 16).ok());
        if let Some(c) = code.and_then(char::from_u32) {
            decoded.push(c);
            rest = &digits[4..];
        } else {
            decoded.push('\\');
            rest = after;
        }
    }
    decoded + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_back(label: &MotionLabel) -> MotionLabel {
        let text = label_lines(label).iter().fold(String::new(), |text, line| {
            assert!(!line.contains('\r') && line.trim_end() == line, "{line:?}");
            text + "    " + line + "\n"
        });
        let labels = stated_labels(&format!("{text}lbr.move(m);\nlbr.move(m);\n"));
        let [(number, read)] = &labels[..] else { panic!("{labels:?}") };
        assert_eq!(*number as usize, text.lines().count() + 1);
        read.clone()
    }

    #[test]
    fn labels_are_read_back() {
        let comment = " indented\n\nC:\\u002a */ \u{202e}溶接\ttab \n";
        for label in [
            MotionLabel::named("a: b").with_comment(comment).in_group("pick // place"),
            MotionLabel::named("ends with a space "),
            MotionLabel::default().with_comment(""),
            MotionLabel::default().in_group("\\"),
        ] {
            assert_eq!(read_back(&label), label);
        }
        let read = read_back(&MotionLabel::default().with_comment("a\r\nb\rc"));
        assert_eq!(read.comment.as_deref(), Some("a\nb\nc"));
    }

    #[test]
    fn other_comments_are_no_labels() {
        for text in [
            "// approach\nlbr.move(m);",
            "// name: approach\nlbr.move(m);",
            "// iiwasim: 0.4 s\nlbr.move(m);",
            "lbr.move(m); // iiwasim name: approach\nlbr.move(m);",
            "// iiwasim speed: 3\nlbr.move(m);",
            "// iiwasim name: at the end",
        ] {
            assert_eq!(stated_labels(text), [], "{text}");
        }
        // Another comment may follow.
        let labels = stated_labels("// iiwasim name: a\n// approach\nlbr.move(m);");
        assert_eq!(labels, [(3, MotionLabel::named("a"))]);
        // An empty line separates the comment from the statement.
        let labels = stated_labels("// iiwasim name: a\n\nlbr.move(m);");
        assert_eq!(labels, [(2, MotionLabel::named("a"))]);
    }
}
