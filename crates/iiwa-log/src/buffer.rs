//! The end of a file in memory, for a writer that keeps its stream to itself.

use std::io::{self, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A stream that holds what was written since it was [emptied](Self::empty) last, at the offsets
/// that it has in the file. Clones share it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffer(Arc<Mutex<BufferContent>>);

#[derive(Debug, Default)]
struct BufferContent {
    /// The offset of the first byte.
    start: u64,
    bytes: Vec<u8>,
    /// The place of the next byte in `bytes`.
    at: usize,
}

impl Buffer {
    /// The offset of the end in the file.
    pub(crate) fn end(&self) -> u64 {
        let content = self.content();
        content.start + content.bytes.len() as u64
    }

    /// Takes what it holds and goes on after it.
    pub(crate) fn empty(&self) -> Vec<u8> {
        let mut content = self.content();
        let bytes = std::mem::take(&mut content.bytes);
        content.start += bytes.len() as u64;
        content.at = 0;
        bytes
    }

    fn content(&self) -> MutexGuard<'_, BufferContent> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Write for Buffer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut content = self.content();
        let at = content.at;
        let over = bytes.len().min(content.bytes.len() - at);
        content.bytes[at..at + over].copy_from_slice(&bytes[..over]);
        content.bytes.extend(&bytes[over..]);
        content.at += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Buffer {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let mut content = self.content();
        let offset = match to {
            SeekFrom::Start(offset) => Some(offset),
            SeekFrom::Current(by) => (content.start + content.at as u64).checked_add_signed(by),
            SeekFrom::End(by) => {
                (content.start + content.bytes.len() as u64).checked_add_signed(by)
            }
        };
        offset
            .and_then(|offset| usize::try_from(offset.checked_sub(content.start)?).ok())
            .filter(|at| *at <= content.bytes.len())
            .map(|at| {
                content.at = at;
                content.start + at as u64
            })
            .ok_or_else(|| io::ErrorKind::InvalidInput.into())
    }
}
