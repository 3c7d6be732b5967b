//! A file that grows and is whole at every moment.
//!
//! An MCAP file ends with an index of everything before it, so what is added comes before the old
//! end and a new end after it. A process can be killed between any two pages (4 KiB) of a write.
//! So every step here either changes nothing that a reader looks at, or is so small that it happens
//! as one; between the steps, the file is whole as seen from its end, through the index, as well as
//! from its start, record by record:
//!
//! 1. A second footer, at the end of a page far enough beyond the end: it points to the old
//!    summary. What lies between is a hole.
//! 2. A copy of the old tail into the hole, before that footer.
//! 3. The second footer points to the copy.
//! 4. The old tail turns into the content of a record that readers pass over, up to the copy.
//! 5. In there, what is added and the new tail are written.
//! 6. The header of that record becomes the one of the first record that was added.
//! 7. The file is cut off behind the new tail.
//!
//! From 1 to 4 and from 6 to 7, who reads from the start finds bytes after the end of the file; and
//! from 6 to 7, what was added, which the index does not have yet.

use std::io::{self, SeekFrom};

use mcap::McapError;

use crate::record::{PADDING, RECORD_HEADER_BYTES, record_header};
use crate::storage::Storage;
use crate::tail::{FOOTER_BYTES, FOOTER_CONTENT, FOOTER_CRC};

/// What Linux writes as one, at least: a page of memory.
pub(crate) const PAGE_BYTES: u64 = 4096;

/// Whether a record's header at `offset` would lie in two pages.
pub(crate) fn header_is_torn(offset: u64) -> bool {
    offset % PAGE_BYTES > PAGE_BYTES - RECORD_HEADER_BYTES as u64
}

/// A file that grows and is whole at every moment.
#[derive(Debug)]
pub(crate) struct WholeFile<S> {
    storage: S,
    /// Where the data section ends and the tail begins.
    data_end: u64,
    end: u64,
    failed: bool,
}

impl<S: Storage> WholeFile<S> {
    /// Writes `data` and its `tail` into an empty storage.
    pub(crate) fn new(mut storage: S, data: &[u8], tail: &[u8]) -> Result<Self, McapError> {
        storage.seek(SeekFrom::Start(0))?;
        storage.write_all(&[data, tail].concat())?;
        storage.flush()?;
        let data_end = data.len() as u64;
        Ok(Self { storage, data_end, end: data_end + tail.len() as u64, failed: false })
    }

    pub(crate) fn into_inner(self) -> S {
        self.storage
    }

    /// Puts `new` in the place of the tail: whole records, of which the first `data_bytes` are the
    /// data section's, and a tail. `old_tail` gives the tail of now for an end of the data section.
    ///
    /// After an error the file has what it had before, and takes nothing more.
    pub(crate) fn grow(
        &mut self,
        old_tail: impl Fn(u64) -> Result<Vec<u8>, McapError>,
        new: &[u8],
        data_bytes: usize,
    ) -> Result<(), McapError> {
        if std::mem::replace(&mut self.failed, true) {
            return Err(McapError::AttemptedWriteAfterFailure);
        }
        let new_end = self.data_end + new.len() as u64;
        let tail_bytes = self.end - self.data_end;
        let copy_end = (new_end.max(self.end) + tail_bytes).next_multiple_of(PAGE_BYTES);
        let copy = copy_end - tail_bytes;

        let made_room = self.make_room(&old_tail, copy, copy_end);
        if made_room.is_err() {
            // The old file is still there, in front. If not even this succeeds, the second footer
            // points to its summary.
            let _ = self.storage.set_len(self.end);
        }
        made_room?;
        let (header, rest) = new.split_at(RECORD_HEADER_BYTES.min(new.len()));
        self.write(self.data_end + RECORD_HEADER_BYTES as u64, rest)?;
        self.write(self.data_end, header)?;
        self.storage.set_len(new_end)?;
        self.storage.flush()?;

        self.data_end += data_bytes as u64;
        self.end = new_end;
        self.failed = false;
        Ok(())
    }

    /// Moves the tail to `copy` and leaves a record to pass over in its place.
    fn make_room(
        &mut self,
        old_tail: &impl Fn(u64) -> Result<Vec<u8>, McapError>,
        copy: u64,
        copy_end: u64,
    ) -> Result<(), McapError> {
        let footer_start = copy_end - FOOTER_BYTES as u64;

        let mut footer = footer_of(old_tail(self.data_end)?);
        // It would count what lies between.
        footer[FOOTER_CRC].fill(0);
        self.write(footer_start, &footer)?;

        let moved = old_tail(copy)?;
        self.write(copy, &moved[..moved.len() - FOOTER_BYTES])?;
        let footer = footer_of(moved);
        self.write(footer_start + FOOTER_CONTENT.start as u64, &footer[FOOTER_CONTENT])?;

        let length = copy - self.data_end - RECORD_HEADER_BYTES as u64;
        self.write(self.data_end, &record_header(PADDING, length))?;
        Ok(())
    }

    fn write(&mut self, offset: u64, bytes: &[u8]) -> io::Result<()> {
        self.storage.seek(SeekFrom::Start(offset))?;
        self.storage.write_all(bytes)
    }
}

/// The footer and the magic at the end of a tail.
fn footer_of(mut tail: Vec<u8>) -> Vec<u8> {
    tail.split_off(tail.len() - FOOTER_BYTES)
}
