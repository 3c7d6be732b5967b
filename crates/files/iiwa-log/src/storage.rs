//! Storage of a recorder.

use std::fs::File;
use std::io::{self, Cursor, Seek, Write};

/// Stream that can also be truncated, for which `std` has no trait.
pub trait Storage: Write + Seek {
    /// Sets the length of the content to `len` bytes; the rest is lost.
    ///
    /// # Errors
    ///
    /// Errors of the storage.
    fn set_len(&mut self, len: u64) -> io::Result<()>;
}

impl Storage for File {
    fn set_len(&mut self, len: u64) -> io::Result<()> {
        Self::set_len(self, len)
    }
}

impl Storage for Cursor<Vec<u8>> {
    fn set_len(&mut self, len: u64) -> io::Result<()> {
        let len = usize::try_from(len).map_err(io::Error::other)?;
        self.get_mut().resize(len, 0);
        Ok(())
    }
}

impl<S: Storage + ?Sized> Storage for &mut S {
    fn set_len(&mut self, len: u64) -> io::Result<()> {
        S::set_len(self, len)
    }
}
