//! The reader of a queue.

use std::{
    fs::{self, File},
    io::{self, BufReader, Seek, SeekFrom},
    time::{Duration, Instant},
};

use super::{
    cursor::Cursor,
    queue::{Spool, path_of},
    segment::{HEAD_BYTES, MAGIC, read_record},
    spool_file,
};

/// A record of a queue.
pub type QueueRecord = Vec<u8>;

/// Interval at which the position of the last commit is saved.
const SAVE_EVERY: Duration = Duration::from_secs(1);

/// Reader of a queue, starting at the last commit.
#[derive(Debug)]
pub struct SpoolReader {
    committed: Cursor,
    /// Position after the last batch.
    next: Cursor,
    /// Open file of the segment of `next`, at this position.
    file: Option<BufReader<File>>,
    saved: (Cursor, Instant),
}

impl SpoolReader {
    pub(super) fn new(cursor: Cursor) -> Self {
        Self { committed: cursor, next: cursor, file: None, saved: (cursor, Instant::now()) }
    }

    /// Returns the next records, up to a number and a size in bytes, at least one if available. The
    /// records are returned again after [`rewind`](Self::rewind), until they are committed.
    ///
    /// # Errors
    ///
    /// Any error of the file system.
    pub fn batch(
        &mut self,
        spool: &Spool,
        max_records: usize,
        max_bytes: usize,
    ) -> io::Result<Vec<QueueRecord>> {
        let mut batch = Vec::new();
        let mut bytes = 0;
        while batch.len() < max_records && bytes < max_bytes {
            match self.record(spool)? {
                Some(record) => {
                    bytes += record.len();
                    batch.push(record);
                }
                None => break,
            }
        }
        Ok(batch)
    }

    /// Resets the reader, so that the batches since the last commit are read again.
    pub fn rewind(&mut self) {
        self.next = self.committed;
        self.file = None;
    }

    /// Commits the batches read so far, and removes their segments.
    ///
    /// # Errors
    ///
    /// Any error of the file system. In this case the commit is merely repeated after a restart.
    pub fn commit(&mut self, spool: &Spool) -> io::Result<()> {
        self.committed = self.next;
        let (saved, saved_at) = self.saved;
        let has_moved = saved != self.committed;
        if has_moved
            && (saved_at.elapsed() >= SAVE_EVERY || saved.segment != self.committed.segment)
        {
            self.save(spool)?;
        }
        let mut state = spool.lock();
        state.committed = (self.committed.segment, self.committed.records);
        while state.segments.len() > 1
            && let Some(first) = state.segments.front()
            && first.number < self.committed.segment
        {
            let path = path_of(&spool.folder, first.number);
            state.segments.pop_front();
            fs::remove_file(path)?;
        }
        Ok(())
    }

    /// Saves the position of the last commit, such as before the end of the program.
    ///
    /// # Errors
    ///
    /// Any error of the file system.
    pub fn save(&mut self, spool: &Spool) -> io::Result<()> {
        self.committed.save(&spool.folder)?;
        self.saved = (self.committed, Instant::now());
        Ok(())
    }

    fn record(&mut self, spool: &Spool) -> io::Result<Option<QueueRecord>> {
        loop {
            let Some(is_last) = self.seek(spool)? else { return Ok(None) };
            let Some(file) = &mut self.file else { return Ok(None) };
            if let Some(record) = read_record(file)? {
                self.next.offset += HEAD_BYTES + record.len() as u64;
                self.next.records += 1;
                return Ok(Some(record));
            }
            if is_last {
                // Records written later are read from the end of this record on.
                self.file = None;
                return Ok(None);
            }
            self.next = Cursor { segment: self.next.segment + 1, ..Cursor::default() };
            self.file = None;
        }
    }

    /// Opens the segment of the next record, or the first existing segment after it. Returns true
    /// if this is the last segment; `None` if all records are read.
    fn seek(&mut self, spool: &Spool) -> io::Result<Option<bool>> {
        let mut state = spool.lock();
        let index = state.segments.iter().position(|it| it.number >= self.next.segment);
        let Some(place) = index else { return Ok(None) };
        let segment = state.segments[place];
        let is_last = place + 1 == state.segments.len();
        if segment.number != self.next.segment {
            self.next = Cursor { segment: segment.number, ..Cursor::default() };
            self.file = None;
        }
        self.next.offset = self.next.offset.max(MAGIC.len() as u64);
        if is_last {
            if self.next.offset >= segment.bytes {
                return Ok(None);
            }
            state.tail.flush()?;
        }
        if self.file.is_none() {
            let mut file =
                BufReader::new(spool_file::open(&path_of(&spool.folder, segment.number))?);
            file.seek(SeekFrom::Start(self.next.offset))?;
            self.file = Some(file);
        }
        Ok(Some(is_last))
    }
}
