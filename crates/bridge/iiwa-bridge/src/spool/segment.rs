//! Files of a queue.

use std::{
    fs::File,
    io::{self, BufReader, Read, Write},
    path::Path,
    time::{Duration, Instant},
};

use super::spool_file;

/// First bytes of a segment.
pub(super) const MAGIC: &[u8; 8] = b"iiwaspl1";

/// Size of length and checksum before each record.
const HEAD: usize = 8;
pub(super) const HEAD_BYTES: u64 = HEAD as u64;

/// Maximum length of a record: a larger length in a file indicates damage.
pub(super) const MAX_RECORD_BYTES: usize = 32 << 20;

/// Maximum number of appended bytes that are written together.
const BUFFER_BYTES: usize = 64 << 10;

/// Writer of a segment.
#[derive(Debug)]
pub(super) struct Appender {
    file: File,
    /// Number of bytes in the file.
    written: u64,
    buffer: Vec<u8>,
    /// Number of records in the buffer.
    buffered: u64,
    /// Time at which the first buffered record was appended.
    since: Instant,
}

/// Maximum time of a record in the buffer: a killed process does not lose older records.
const BUFFER_TIME: Duration = Duration::from_millis(50);

impl Appender {
    pub(super) fn create(path: &Path) -> io::Result<Self> {
        let mut file = spool_file::create(path)?;
        file.write_all(MAGIC)?;
        let written = MAGIC.len() as u64;
        Ok(Self {
            file,
            written,
            buffer: Vec::with_capacity(BUFFER_BYTES),
            buffered: 0,
            since: Instant::now(),
        })
    }

    /// Returns the length of the segment, including buffered records.
    pub(super) fn bytes(&self) -> u64 {
        self.written + self.buffer.len() as u64
    }

    pub(super) fn append(&mut self, record: &[u8]) -> io::Result<()> {
        let too_long =
            || io::Error::new(io::ErrorKind::InvalidInput, "the record is longer than 32 MiB");
        let length = u32::try_from(record.len()).map_err(|_| too_long())?;
        if record.len() > MAX_RECORD_BYTES {
            return Err(too_long());
        }
        if self.buffer.len() + record.len() > BUFFER_BYTES {
            self.flush()?;
        }
        self.buffer.extend_from_slice(&length.to_le_bytes());
        self.buffer.extend_from_slice(&crc32fast::hash(record).to_le_bytes());
        self.buffer.extend_from_slice(record);
        if self.buffered == 0 {
            self.since = Instant::now();
        }
        self.buffered += 1;
        if self.since.elapsed() >= BUFFER_TIME { self.flush() } else { Ok(()) }
    }

    /// Returns the number of buffered records.
    pub(super) fn buffered(&self) -> u64 {
        self.buffered
    }

    /// Writes the buffered records to the system. If this fails, all of them are dropped.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        if self.buffer.is_empty() {
            return Ok(());
        }
        let written = self.file.write_all(&self.buffer);
        if written.is_err() {
            // Partial records are removed, because records appended after them could not be found.
            self.file.set_len(self.written)?;
            io::Seek::seek(&mut self.file, io::SeekFrom::Start(self.written))?;
            self.buffer.clear();
        }
        self.written += self.buffer.len() as u64;
        self.buffer.clear();
        self.buffered = 0;
        written
    }
}

/// Returns the number of bytes and of records of a segment, up to its end or the first damage.
pub(super) fn scan(path: &Path) -> io::Result<(u64, u64)> {
    let mut file = BufReader::new(spool_file::open(path)?);
    let mut magic = [0; MAGIC.len()];
    if file.read_exact(&mut magic).is_err() || magic != *MAGIC {
        return Ok((0, 0));
    }
    let (mut bytes, mut records) = (MAGIC.len() as u64, 0);
    while let Some(record) = read_record(&mut file)? {
        bytes += HEAD_BYTES + record.len() as u64;
        records += 1;
    }
    Ok((bytes, records))
}

/// Reads the next record; `None` at the end, and at damage.
pub(super) fn read_record(file: &mut impl Read) -> io::Result<Option<Vec<u8>>> {
    let mut head = [0; HEAD];
    if !read_all(file, &mut head)? {
        return Ok(None);
    }
    let [l0, l1, l2, l3, c0, c1, c2, c3] = head;
    let length = u32::from_le_bytes([l0, l1, l2, l3]) as usize;
    if length > MAX_RECORD_BYTES {
        return Ok(None);
    }
    let mut record = vec![0; length];
    let is_whole = read_all(file, &mut record)?
        && crc32fast::hash(&record) == u32::from_le_bytes([c0, c1, c2, c3]);
    Ok(is_whole.then_some(record))
}

/// Fills the buffer; `false` if the file ends before.
fn read_all(file: &mut impl Read, buffer: &mut [u8]) -> io::Result<bool> {
    match file.read_exact(buffer) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}
