//! File that grows and is complete at every moment.
//!
//! An MCAP file ends with an index of everything before it, so new data go before the old tail,
//! with a new tail after them. A process can be killed between any two pages (4 KiB) of a write. So
//! every step here either changes no byte that a reader looks at, or is small enough to be atomic;
//! between the steps, the file is complete as seen from its end, through the index, as well as from
//! its start, record by record:
//!
//! 1. Write a second footer, at the end of a page far enough beyond the end: it points to the old
//!    summary. Between the two is a hole.
//! 2. Copy the old tail into the hole, before that footer.
//! 3. Let the second footer point to the copy.
//! 4. Turn the old tail into the content of a record that readers skip, up to the copy.
//! 5. Write the new data and the new tail into that record.
//! 6. Replace the header of that record by the header of the first new record.
//! 7. Truncate the file after the new tail.
//!
//! From 1 to 4 and from 6 to 7, a reader that starts at the beginning finds bytes after the end of
//! the file; and from 6 to 7, also the new data, which the index does not contain yet.

use std::io::{self, SeekFrom};

use mcap::McapError;

use crate::record::{PADDING, RECORD_HEADER_BYTES, record_header};
use crate::storage::Storage;
use crate::tail::{FOOTER_BYTES, FOOTER_CONTENT, FOOTER_CRC};

/// Number of bytes that Linux writes atomically, at least: a page of memory.
pub(crate) const PAGE_BYTES: u64 = 4096;

/// Returns true if a record header at `offset` would span two pages.
pub(crate) fn header_is_torn(offset: u64) -> bool {
    offset % PAGE_BYTES > PAGE_BYTES - RECORD_HEADER_BYTES as u64
}

/// File that grows and is complete at every moment.
#[derive(Debug)]
pub(crate) struct WholeFile<S> {
    storage: S,
    /// Offset where the data section ends and the tail begins.
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

    /// Replaces the tail by `new`: complete records, of which the first `data_bytes` belong to the
    /// data section, and a tail. `old_tail` returns the current tail for an end of the data
    /// section.
    ///
    /// After an error the file keeps its previous content, and accepts no more data.
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
            // The old file is still intact at the beginning. If even the truncation fails, the
            // second footer points to its summary.
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

    /// Moves the tail to `copy` and leaves a record that readers skip in its place.
    fn make_room(
        &mut self,
        old_tail: &impl Fn(u64) -> Result<Vec<u8>, McapError>,
        copy: u64,
        copy_end: u64,
    ) -> Result<(), McapError> {
        let footer_start = copy_end - FOOTER_BYTES as u64;

        let mut footer = footer_of(old_tail(self.data_end)?);
        // The checksum would include the bytes in between.
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

/// Returns the footer and the magic at the end of a tail.
fn footer_of(mut tail: Vec<u8>) -> Vec<u8> {
    tail.split_off(tail.len() - FOOTER_BYTES)
}
