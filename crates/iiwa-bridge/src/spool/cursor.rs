//! Places in a queue.

use std::{fs, io, path::Path};

/// The file with the place of the last commit.
const FILE: &str = "cursor";

/// A place in a queue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Cursor {
    pub(super) segment: u64,
    pub(super) offset: u64,
    /// Records of the segment before it; not known of a saved place.
    pub(super) records: u64,
}

impl Cursor {
    /// The saved place, or the beginning.
    pub(super) fn load(folder: &Path) -> Self {
        let text = fs::read_to_string(folder.join(FILE)).unwrap_or_default();
        let mut numbers = text.split_whitespace().map(str::parse);
        match (numbers.next(), numbers.next()) {
            (Some(Ok(segment)), Some(Ok(offset))) => Self { segment, offset, records: 0 },
            _ => Self::default(),
        }
    }

    pub(super) fn save(self, folder: &Path) -> io::Result<()> {
        let Self { segment, offset, .. } = self;
        // Whole or not at all.
        let written = folder.join("cursor.new");
        fs::write(&written, format!("{segment} {offset}\n"))?;
        fs::rename(written, folder.join(FILE))
    }
}
