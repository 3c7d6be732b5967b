//! A bounded queue on disk for messages that a broker has not yet accepted.
//!
//! Records are appended to segments, files of a few MB. The reader sends a batch and then commits
//! it; committed segments are removed, mostly before the system has written them to disk. If the
//! queue is full, the oldest segment is removed uncommitted, and its records are counted as
//! dropped.
//!
//! A killed process loses records that were appended in the last 50 ms and not
//! [flushed](Spool::flush). After a restart the queue continues at the last saved commit, which is
//! at most one second old: records may be sent twice, but are not omitted.
//!
//! Format of a segment: `iiwaspl1`, followed by records of length, CRC-32 of the data, data;
//! numbers are little-endian.

mod cursor;
mod queue;
mod reader;
mod segment;
mod spool_file;

use std::{io, path::Path};

pub use queue::{Level, Spool};
pub use reader::{QueueRecord, SpoolReader};

/// Opens the queue in a folder, which is created if it is missing, and the reader of its remaining
/// records.
///
/// ```
/// use iiwa_bridge::spool;
///
/// let folder = tempfile::tempdir()?;
/// let (spool, mut reader) = spool::open(folder.path(), 64 << 20)?;
/// spool.append(b"one")?;
/// spool.append(b"two")?;
/// let batch = reader.batch(&spool, 100, 1 << 20)?;
/// assert_eq!(batch.iter().map(|record| &record[..]).collect::<Vec<_>>(), [b"one", b"two"]);
/// reader.commit(&spool)?;
/// assert!(reader.batch(&spool, 100, 1 << 20)?.is_empty());
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
///
/// The folder cannot be created or read, another process uses it ([`io::ErrorKind::WouldBlock`]),
/// or a symbolic link or a folder has the name of one of its files.
pub fn open(folder: &Path, max_bytes: u64) -> io::Result<(Spool, SpoolReader)> {
    let (spool, cursor) = Spool::open(folder, max_bytes)?;
    Ok((spool, SpoolReader::new(cursor)))
}
