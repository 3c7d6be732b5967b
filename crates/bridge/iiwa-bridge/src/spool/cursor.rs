//! Positions in a queue.

use std::{
    fs,
    io::{self, Read, Write},
    path::Path,
};

use super::spool_file;

/// File with the position of the last commit.
const FILE: &str = "cursor";

/// Maximum length of this file, larger than any position.
const MAX_BYTES: u64 = 100;

/// A position in a queue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Cursor {
    pub(super) segment: u64,
    pub(super) offset: u64,
    /// Number of records of the segment before this position; unknown for a saved position.
    pub(super) records: u64,
}

impl Cursor {
    /// Loads the saved position; the start of the queue if the file is missing or damaged.
    pub(super) fn load(folder: &Path) -> io::Result<Self> {
        let mut text = String::new();
        match spool_file::open(&folder.join(FILE)) {
            Ok(file) => drop(file.take(MAX_BYTES).read_to_string(&mut text)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(error),
        }
        let mut numbers = text.split_whitespace().map(str::parse);
        Ok(match (numbers.next(), numbers.next()) {
            (Some(Ok(segment)), Some(Ok(offset))) => Self { segment, offset, records: 0 },
            _ => Self::default(),
        })
    }

    pub(super) fn save(self, folder: &Path) -> io::Result<()> {
        let Self { segment, offset, .. } = self;
        // Atomic replacement: a temporary file is renamed.
        let written = folder.join("cursor.new");
        spool_file::create(&written)?.write_all(format!("{segment} {offset}\n").as_bytes())?;
        fs::rename(written, folder.join(FILE))
    }
}
