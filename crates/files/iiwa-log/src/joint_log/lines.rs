//! Lines of a text file.

use std::io::{self, BufRead, BufReader, Read};

use memchr::memchr2;

/// Line of a text file.
pub(super) struct TextLine<'a> {
    /// Number of the line, from 1.
    pub(super) number: u64,
    /// The line without its end.
    pub(super) text: &'a [u8],
    /// `false` if the stream ends within the line.
    pub(super) is_complete: bool,
}

/// Reads lines that end with LF, CR or both.
///
/// The `csv` crate counts LF only, and places a record at the blank lines before it: its line
/// numbers would be wrong in messages.
pub(super) struct TextLines<R> {
    stream: BufReader<R>,
    line: Vec<u8>,
    number: u64,
    /// `true` if an LF at the start of the next line belongs to the CR of this one.
    after_cr: bool,
}

impl<R: Read> TextLines<R> {
    /// Reads the lines after the line with the number `before`.
    pub(super) fn after(before: u64, stream: R) -> Self {
        let stream = BufReader::with_capacity(1 << 18, stream);
        Self { stream, line: Vec::new(), number: before, after_cr: false }
    }

    /// Reads the next line. Returns `None` at the end of the stream.
    pub(super) fn next(&mut self) -> io::Result<Option<TextLine<'_>>> {
        self.line.clear();
        self.number += 1;
        let is_complete = loop {
            let bytes = match self.stream.fill_buf() {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                bytes => bytes?,
            };
            if bytes.is_empty() {
                break false;
            }
            if std::mem::take(&mut self.after_cr) && bytes[0] == b'\n' {
                self.stream.consume(1);
                continue;
            }
            let end = memchr2(b'\r', b'\n', bytes);
            self.line.extend_from_slice(&bytes[..end.unwrap_or(bytes.len())]);
            self.after_cr = end.is_some_and(|end| bytes[end] == b'\r');
            let length = end.map_or(bytes.len(), |end| end + 1);
            self.stream.consume(length);
            if end.is_some() {
                break true;
            }
        };
        let Self { number, line, .. } = self;
        let line = TextLine { number: *number, text: line, is_complete };
        Ok(Some(line).filter(|line| line.is_complete || !line.text.is_empty()))
    }
}
