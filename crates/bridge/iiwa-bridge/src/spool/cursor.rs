//! Places in a queue.

use std::{
    fs,
    io::{self, Read, Write},
    path::Path,
};

use super::own_file;

/// The file with the place of the last commit.
const FILE: &str = "cursor";

/// Longer than any place in that file.
const MAX_BYTES: u64 = 100;

/// A place in a queue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Cursor {
    pub(super) segment: u64,
    pub(super) offset: u64,
    /// Records of the segment before it; not known of a saved place.
    pub(super) records: u64,
}

impl Cursor {
    /// Loads the saved position; the start of the queue if the file is missing or damaged.
    pub(super) fn load(folder: &Path) -> io::Result<Self> {
        let mut text = String::new();
        match own_file::open(&folder.join(FILE)) {
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
        // Whole or not at all.
        let written = folder.join("cursor.new");
        own_file::create(&written)?.write_all(format!("{segment} {offset}\n").as_bytes())?;
        fs::rename(written, folder.join(FILE))
    }
}
