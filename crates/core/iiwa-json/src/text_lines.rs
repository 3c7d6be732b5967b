//! Lines of a text.

use std::io::{self, BufRead};

use memchr::memchr2;

use crate::encoding::bytes_without_mark;

/// Line of a text.
#[derive(Clone, Copy, Debug)]
pub struct TextLine<'a> {
    /// Number of the line, from 1.
    pub number: u64,
    /// The line without its end; the first line without a byte order mark of UTF-8.
    pub text: &'a [u8],
    /// `false` if the stream ends within the line.
    pub is_complete: bool,
}

/// Reads lines that end with LF, CR or both. A line is returned as soon as its end is read.
///
/// The `csv` crate counts LF only, and places a record at the blank lines before it: its line
/// numbers would be wrong in messages.
#[derive(Debug)]
pub struct TextLines<R> {
    stream: R,
    line: Vec<u8>,
    number: u64,
    /// `true` if an LF at the start of the next line belongs to the CR of this one.
    after_cr: bool,
}

impl<R: BufRead> TextLines<R> {
    /// Reads the lines of `stream`.
    pub fn new(stream: R) -> Self {
        Self { stream, line: Vec::new(), number: 0, after_cr: false }
    }

    /// Reads the next line. Returns `None` at the end of the stream.
    ///
    /// # Errors
    ///
    /// Errors of the stream.
    pub fn next_line(&mut self) -> io::Result<Option<TextLine<'_>>> {
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
        let text = if self.number == 1 { bytes_without_mark(&self.line) } else { &self.line };
        let line = TextLine { number: self.number, text, is_complete };
        Ok(Some(line).filter(|line| line.is_complete || !line.text.is_empty()))
    }
}
