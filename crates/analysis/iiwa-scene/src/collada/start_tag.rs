//! Bounds on start tags, checked before the document is parsed.
//!
//! The parser compares each attribute of a tag with all previous ones, and each namespace of an
//! element with those of all elements around it: without these bounds, a file of some hundred
//! kilobytes takes hours.

use super::ColladaError;

/// Maximum length of a start tag, in bytes.
const MAX_LENGTH: usize = 1 << 16;

/// Maximum number of attributes of a start tag; Collada defines at most ten.
const MAX_ATTRIBUTES: usize = 256;

/// Maximum number of namespace declarations in a file; one or two are usual.
const MAX_NAMESPACES: usize = 256;

/// Checks all start tags of a document.
///
/// Text that is not well-formed may be accepted: up to its first fault, the parser finds the same
/// tags as this function.
pub(super) fn check_all(text: &str) -> Result<(), ColladaError> {
    let mut at = 0;
    let mut namespaces = 0;
    while let Some(found) = text[at..].find('<') {
        at += found;
        let rest = &text[at..];
        let delimiters = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("</", ">")];
        let found = delimiters.into_iter().find(|(opening, _)| rest.starts_with(opening));
        at += if let Some((opening, closing)) = found {
            let Some(length) = rest[opening.len()..].find(closing) else { return Ok(()) };
            opening.len() + length + closing.len()
        } else if rest.starts_with("<!") {
            // A document type, or a fault: the parser refuses both.
            return Ok(());
        } else {
            let refused = |message| Err(error(text, at, message));
            let Some(tag) = start_tag(rest) else {
                return refused(format!(
                    "a start tag has more than {MAX_LENGTH} bytes or {MAX_ATTRIBUTES} attributes"
                ));
            };
            namespaces += tag.matches("xmlns").count();
            if namespaces > MAX_NAMESPACES {
                return refused(format!(
                    "the file has more than {MAX_NAMESPACES} namespace declarations (`xmlns`)"
                ));
            }
            tag.len()
        };
    }
    Ok(())
}

/// Returns the start tag at the start of a text, or the part of it that ends with the text or
/// before another `<`, where the parser refuses it; `None` if the tag exceeds a bound.
fn start_tag(text: &str) -> Option<&str> {
    let mut quote = None;
    let mut attributes = 0;
    for (at, byte) in text.bytes().enumerate().skip(1) {
        if at == MAX_LENGTH {
            return None;
        }
        match (quote, byte) {
            (_, b'<') => return Some(&text[..at]),
            (Some(open), _) if byte == open => quote = None,
            (None, b'>') => return Some(&text[..=at]),
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'=') => {
                attributes += 1;
                if attributes > MAX_ATTRIBUTES {
                    return None;
                }
            }
            _ => {}
        }
    }
    Some(text)
}

fn error(text: &str, at: usize, message: String) -> ColladaError {
    let before = &text[..at];
    let line = before.rsplit('\n').next().unwrap_or_default();
    let number = |count: usize| u32::try_from(count + 1).unwrap_or(u32::MAX);
    ColladaError {
        line: number(before.matches('\n').count()),
        column: number(line.chars().count()),
        message,
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;

    fn attributes(count: usize) -> String {
        (0..count).fold(String::new(), |mut text, number| {
            write!(text, " a{number}='>'").unwrap();
            text
        })
    }

    #[test]
    fn start_tags_are_bounded() {
        let long = format!("a='{}'", "x".repeat(100 << 10));
        let many = attributes(MAX_ATTRIBUTES + 1);
        let most = attributes(MAX_ATTRIBUTES);
        let refused = "more than 65536 bytes or 256 attributes";
        for (text, line, column) in [
            (format!("<a {long}/>"), 1, 1),
            (format!("<a>\n \u{fc}<b{many}/></a>"), 2, 3),
            // Delimiters in values, comments, character data and instructions.
            (format!("<a b='/>' {long}>"), 1, 1),
            (format!("<!-- <a --><a><![CDATA[<b ]]><?c <d ?><e{many}/></a>"), 1, 39),
            (format!("<a b=\"it's\" c='\"'><b{many}/></a>"), 1, 19),
            // Tags that do not end.
            (format!("<a {long}"), 1, 1),
            (format!("<a{many}<"), 1, 1),
        ] {
            let error = check_all(&text).unwrap_err();
            assert_eq!((error.line, error.column), (line, column), "{error}");
            assert!(error.message.contains(refused), "{error}");
        }
        for text in [
            format!("<a{most}/>"),
            format!("<a>{}</a>", format!("<b{most}/>").repeat(3)),
            format!("<!-- <a {long}> --><a> {long} </a>"),
            format!("<a><![CDATA[<b{many}>]]></a>"),
            format!("<a><?b <c{many}> ?></a>"),
        ] {
            assert_eq!(check_all(&text), Ok(()));
            assert!(roxmltree::Document::parse(&text).is_ok());
        }
        // The parser refuses a document type and tags that do not end.
        for text in [format!("<!DOCTYPE a><a{many}/>"), "<a b='<'".to_owned(), "<!-- ".to_owned()] {
            assert_eq!(check_all(&text), Ok(()));
            assert!(roxmltree::Document::parse(&text).is_err());
        }
    }

    /// Nested declarations take the parser cubic time.
    #[test]
    fn namespaces_are_bounded() {
        let nested = |count: usize| {
            let open = (0..count).fold(String::new(), |mut text, number| {
                write!(text, "<a xmlns:n{number}='u'>").unwrap();
                text
            });
            open + &"</a>".repeat(count)
        };
        assert_eq!(check_all(&nested(256)), Ok(()));
        let error = check_all(&nested(20_000)).unwrap_err();
        assert!(error.message.contains("more than 256 namespace declarations"), "{error}");
    }
}
