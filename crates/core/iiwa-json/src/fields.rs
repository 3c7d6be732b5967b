//! Fields of a table line.

use crate::excerpt::excerpt;

/// Splits a line into fields without spaces around them; spaces as delimiters may be repeated.
/// Quotes around a field enclose delimiters; a double quote in it is written twice.
pub(crate) fn fields(line: &str, delimiter: char) -> Result<Vec<String>, String> {
    let mut fields = Vec::new();
    let mut rest = line;
    loop {
        rest = rest.trim_start_matches(|c: char| c == ' ' || (c == '\t' && delimiter != '\t'));
        let (field, after) = match rest.strip_prefix('"') {
            None => {
                let end = rest.find(delimiter).unwrap_or(rest.len());
                (rest[..end].trim().to_owned(), &rest[end..])
            }
            Some(quoted) => {
                let (field, after) = unquoted(quoted)?;
                let after = after.trim_start_matches(|c: char| c == ' ' && delimiter != ' ');
                if !(after.is_empty() || after.starts_with(delimiter)) {
                    let field = excerpt(&field);
                    return Err(format!("there is text after the quoted field \"{field}\""));
                }
                (field.trim().to_owned(), after)
            }
        };
        fields.push(field);
        match after.strip_prefix(delimiter) {
            Some(next) => rest = next,
            None => return Ok(fields),
        }
    }
}

/// Reads a field up to its closing quote, and returns the text after it.
fn unquoted(text: &str) -> Result<(String, &str), String> {
    let mut field = String::new();
    let mut rest = text;
    while let Some((part, after)) = rest.split_once('"') {
        field.push_str(part);
        match after.strip_prefix('"') {
            Some(next) => {
                field.push('"');
                rest = next;
            }
            None => return Ok((field, after)),
        }
    }
    Err("a quote is not closed".to_owned())
}
