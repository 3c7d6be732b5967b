//! Queue operations: appending and dropping records.

use std::{
    collections::VecDeque,
    fs::{self, File},
    io,
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};

use super::{
    cursor::Cursor,
    segment::{Appender, scan},
    spool_file,
};

/// Size at which a segment is complete, in bytes.
const SEGMENT_BYTES: u64 = 4 << 20;

/// Lock file of the process that uses the queue.
const LOCK: &str = "lock";

/// A bounded queue on disk, with one reader.
#[derive(Debug)]
pub struct Spool {
    pub(super) folder: PathBuf,
    max_bytes: u64,
    state: Mutex<QueueState>,
    _lock: File,
}

/// State of the segments.
#[derive(Debug)]
pub(super) struct QueueState {
    /// Segments in order; all but the last one are complete.
    pub(super) segments: VecDeque<SpoolSegment>,
    pub(super) tail: Appender,
    dropped: u64,
    /// Number of the segment of the last commit, and its number of committed records.
    pub(super) committed: (u64, u64),
}

/// A segment.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpoolSegment {
    pub(super) number: u64,
    pub(super) bytes: u64,
    records: u64,
}

/// Level of a queue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Level {
    /// Bytes in segments, including sent segments that have not been removed yet.
    pub bytes: u64,
    /// Number of records lost since the start: the queue was full or could not be written, or the
    /// broker refused them.
    pub dropped: u64,
}

impl Spool {
    /// Opens the queue in a folder, which is created if it is missing. Also returns the position of
    /// the last commit.
    pub(super) fn open(folder: &Path, max_bytes: u64) -> io::Result<(Self, Cursor)> {
        fs::create_dir_all(folder)?;
        let lock = spool_file::open_to_lock(&folder.join(LOCK))?;
        lock.try_lock().map_err(io::Error::from)?;
        let mut numbers: Vec<u64> =
            fs::read_dir(folder)?.filter_map(|entry| number_of(&entry.ok()?.path())).collect();
        numbers.sort_unstable();
        let cursor = Cursor::load(folder)?;
        let mut segments = VecDeque::new();
        for number in &numbers {
            let path = path_of(folder, *number);
            if *number < cursor.segment {
                fs::remove_file(path)?;
                continue;
            }
            let (bytes, records) = scan(&path)?;
            segments.push_back(SpoolSegment { number: *number, bytes, records });
        }
        // A tail that was cut off by a crash is not continued.
        let next = numbers.last().map_or(0, |last| last + 1).max(cursor.segment + 1);
        let tail = Appender::create(&path_of(folder, next))?;
        segments.push_back(SpoolSegment { number: next, bytes: tail.bytes(), records: 0 });
        let state =
            Mutex::new(QueueState { segments, tail, dropped: 0, committed: (cursor.segment, 0) });
        let spool = Self { folder: folder.to_owned(), max_bytes, state, _lock: lock };
        Ok((spool, cursor))
    }

    /// Appends a record, without waiting for the disk.
    ///
    /// # Errors
    ///
    /// The record cannot be written, for example because the disk is full: it is dropped, with the
    /// previous records that were not written.
    pub fn append(&self, record: &[u8]) -> io::Result<()> {
        let mut state = self.lock();
        let buffered = state.tail.buffered();
        let appended = if state.tail.bytes() >= SEGMENT_BYTES {
            self.begin_segment(&mut state).and_then(|()| state.tail.append(record))
        } else {
            state.tail.append(record)
        };
        if appended.is_err() {
            state.dropped += buffered + 1;
            return appended;
        }
        let bytes = state.tail.bytes();
        if let Some(last) = state.segments.back_mut() {
            last.bytes = bytes;
            last.records += 1;
        }
        Ok(())
    }

    /// Writes all appended records to the system, so that they survive the process.
    ///
    /// # Errors
    ///
    /// The records cannot be written, and are dropped.
    pub fn flush(&self) -> io::Result<()> {
        let mut state = self.lock();
        let buffered = state.tail.buffered();
        state.tail.flush().inspect_err(|_| state.dropped += buffered)
    }

    /// Returns the level.
    #[must_use]
    pub fn level(&self) -> Level {
        let state = self.lock();
        Level { bytes: state.segments.iter().map(|it| it.bytes).sum(), dropped: state.dropped }
    }

    fn begin_segment(&self, state: &mut QueueState) -> io::Result<()> {
        state.tail.flush()?;
        let number = state.segments.back().map_or(0, |last| last.number + 1);
        state.tail = Appender::create(&path_of(&self.folder, number))?;
        state.segments.push_back(SpoolSegment { number, bytes: state.tail.bytes(), records: 0 });
        let mut bytes: u64 = state.segments.iter().map(|it| it.bytes).sum();
        // The new segment needs space for a complete segment.
        while bytes + SEGMENT_BYTES > self.max_bytes && state.segments.len() > 1 {
            let Some(oldest) = state.segments.pop_front() else { break };
            bytes -= oldest.bytes;
            let (segment, records) = state.committed;
            let committed = if oldest.number == segment { records } else { 0 };
            state.dropped += oldest.records.saturating_sub(committed);
            // A remaining file is removed at the next start.
            let _ = fs::remove_file(path_of(&self.folder, oldest.number));
        }
        Ok(())
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, QueueState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

pub(super) fn path_of(folder: &Path, number: u64) -> PathBuf {
    folder.join(format!("{number:012}.spool"))
}

fn number_of(path: &Path) -> Option<u64> {
    let is_segment = path.extension().is_some_and(|extension| extension == "spool");
    path.file_stem()?.to_str()?.parse().ok().filter(|_| is_segment)
}
