//! Format detection.

use std::io::{Cursor, Read};

use super::table::HEAD_BYTES;
use super::{JointLog, JointLogError, LogOptions, recording, table};
use crate::reader::read as read_once;

/// First bytes of an Apache Parquet file.
pub(super) const PARQUET_MAGIC: &[u8] = b"PAR1";

impl JointLog {
    /// Reads a recording in any of the [formats](Self#formats), in one pass. The stream needs no
    /// buffering.
    ///
    /// On success, the log has at least one sample.
    ///
    /// # Errors
    ///
    /// Any [`JointLogError`], apart from those of the checks against a robot.
    pub fn read<R: Read>(stream: R) -> Result<Self, JointLogError> {
        Self::read_with(stream, LogOptions::default())
    }

    /// Reads a recording, with options for the information that column names leave open.
    ///
    /// # Errors
    ///
    /// See [`read`](Self::read).
    pub fn read_with<R: Read>(mut stream: R, options: LogOptions) -> Result<Self, JointLogError> {
        let mut head = vec![0; HEAD_BYTES];
        let mut len = 0;
        while len < head.len() {
            match read_once(&mut stream, &mut head[len..])? {
                0 => break,
                read => len += read,
            }
        }
        head.truncate(len);
        if head.is_empty() {
            return Err(JointLogError::Empty);
        }
        if recording::is_mcap(&head) {
            return recording::read(Cursor::new(head).chain(stream));
        }
        #[cfg(feature = "parquet")]
        if head.starts_with(PARQUET_MAGIC) {
            return super::parquet::read(head, stream, options);
        }
        #[cfg(not(feature = "parquet"))]
        if head.starts_with(PARQUET_MAGIC) {
            return Err(JointLogError::ParquetNotSupported);
        }
        table::read(&head, stream, options)
    }
}
