//! Places of motion list entries.

use iiwa_json::JsonStep;

/// Place of an entry of a motion list, which may be the list of a repeat block.
#[derive(Clone, Copy)]
pub(super) struct EntryPlace<'a> {
    /// Place of the block; `None` in the list of the program.
    pub(super) block: Option<&'a EntryPlace<'a>>,
    /// Index in the list.
    pub(super) index: usize,
}

impl EntryPlace<'_> {
    /// Path from the program to the entry.
    pub(super) fn path(&self) -> Vec<JsonStep<'static>> {
        let mut path = self.block.map(EntryPlace::path).unwrap_or_default();
        path.extend([JsonStep::Key("motions"), JsonStep::Index(self.index)]);
        path
    }

    /// Number of blocks that contain the entry.
    pub(super) fn depth(&self) -> usize {
        self.block.map_or(0, |block| 1 + block.depth())
    }
}
