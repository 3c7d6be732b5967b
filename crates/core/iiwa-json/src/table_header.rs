//! Column names of a table.

use std::fmt;

use crate::{fields::fields, text_lines::TextLine};

/// Kind of a line in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableLine<'a> {
    /// Line without content: blank, or Excel's `sep=`.
    Blank,
    /// Comment, without the `#` or `%` at its start.
    Comment(&'a [u8]),
    /// Column names or values.
    Row(&'a [u8]),
}

impl<'a> TableLine<'a> {
    /// Detects the kind of a line.
    #[must_use]
    pub fn of(line: &'a [u8]) -> Self {
        let text = line.trim_ascii();
        let is_separator = text.len() <= 5 && text.to_ascii_lowercase().starts_with(b"sep=");
        match text {
            [] => Self::Blank,
            [b'#' | b'%', comment @ ..] => Self::Comment(comment.trim_ascii_start()),
            _ if is_separator => Self::Blank,
            // Leading tabs may delimit empty fields.
            _ => Self::Row(line),
        }
    }
}

/// Line of column names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableHeader {
    /// Number of the line, from 1.
    pub line: u64,
    /// Byte between fields: `;`, a tab, `,`, or any number of spaces.
    pub delimiter: u8,
    /// Column names, without spaces and quotes around them. Characters that are not UTF-8 are
    /// replaced.
    pub names: Vec<String>,
}

/// Reason why a line is not a line of column names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HeaderFault {
    /// The line contains numbers, or no names.
    Numbers,
    /// The quotes are wrong.
    Quotes(String),
}

impl fmt::Display for HeaderFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Numbers => f.write_str("the first line has to name the columns"),
            Self::Quotes(message) => f.write_str(message),
        }
    }
}

impl TableHeader {
    /// Splits a line of column names.
    fn parse(line: u64, text: &[u8]) -> Result<Self, HeaderFault> {
        let trimmed = text.trim_ascii();
        let delimiter = [b';', b'\t', b','].into_iter().find(|byte| trimmed.contains(byte));
        let delimiter = delimiter.unwrap_or(b' ');
        let text = if delimiter == b'\t' { text } else { trimmed };
        // Names that are read are ASCII; in other names, the encoding makes no difference.
        let text = String::from_utf8_lossy(text);
        let mut names = fields(&text, char::from(delimiter)).map_err(HeaderFault::Quotes)?;
        names.pop_if(|last| last.is_empty());
        if names.iter().any(|name| name.parse::<f64>().is_ok()) {
            return Err(HeaderFault::Numbers);
        }
        Ok(Self { line, delimiter, names })
    }
}

/// Search for the line of column names: the first line that is neither blank nor a comment.
///
/// The line may be a comment itself, as MATLAB and numpy write it: a comment with the names of
/// columns, or the last comment before a line of numbers.
#[derive(Debug, Default)]
pub struct HeaderSearch {
    last_comment: Option<TableHeader>,
}

impl HeaderSearch {
    /// Examines the next line. Returns the header once it is known: this line, or a comment before
    /// it, in which case this line contains values. `are_columns` returns true for the names of a
    /// table.
    ///
    /// # Errors
    ///
    /// [`HeaderFault`] if the table has no header.
    pub fn examine(
        &mut self,
        line: &TextLine<'_>,
        are_columns: impl FnOnce(&[String]) -> bool,
    ) -> Result<Option<TableHeader>, HeaderFault> {
        match TableLine::of(line.text) {
            TableLine::Blank => Ok(None),
            TableLine::Comment(text) => {
                let header = TableHeader::parse(line.number, text).ok();
                let Some(header) = header.filter(|header| !header.names.is_empty()) else {
                    return Ok(None);
                };
                if are_columns(&header.names) {
                    return Ok(Some(header));
                }
                self.last_comment = Some(header);
                Ok(None)
            }
            TableLine::Row(text) => {
                let comment = self.last_comment.take().filter(|_| starts_with_number(text));
                comment.map_or_else(|| TableHeader::parse(line.number, text), Ok).map(Some)
            }
        }
    }
}

fn starts_with_number(line: &[u8]) -> bool {
    let first = line.trim_ascii().split(|byte| b",; \t".contains(byte)).next().unwrap_or_default();
    let bare = first.strip_prefix(b"\"").and_then(|field| field.strip_suffix(b"\""));
    let number = std::str::from_utf8(bare.unwrap_or(first)).ok().map(str::parse::<f64>);
    number.is_some_and(|number| number.is_ok_and(f64::is_finite))
}
