//! Chunk compression.

use std::io::{self, Cursor};

use zstd::bulk;
use zstd::zstd_safe::{CParameter, compress_bound};

/// Compression level of a file. The method is always zstd, which every MCAP reader supports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Compression {
    /// For files that a user waits for: the default of plans.
    Fast,
    /// For files that grow for hours: the default of recordings. A plan would be a tenth smaller,
    /// and take more than twice as long to compress.
    #[default]
    Small,
}

impl Compression {
    /// Name of the method in a chunk.
    pub(crate) const NAME: &str = "zstd";

    /// Level of zstd. Joint values hardly compress further than at the lowest positive level. At
    /// negative levels, zstd leaves literals uncompressed and searches in longer steps.
    fn level(self) -> i32 {
        match self {
            Self::Fast => -4,
            Self::Small => 1,
        }
    }

    /// Chunk size before compression, bytes. With smaller chunks, all data of a chunk fits into the
    /// processor cache; with larger ones, the index is shorter.
    pub(crate) fn chunk_bytes(self) -> usize {
        match self {
            Self::Fast => 128 * 1024,
            Self::Small => 1024 * 1024,
        }
    }
}

/// Compresses one chunk after the other, and reuses its memory.
pub(crate) struct Compressor(bulk::Compressor<'static>);

impl Compressor {
    pub(crate) fn new(compression: Compression) -> io::Result<Self> {
        let mut zstd = bulk::Compressor::new(compression.level())?;
        if compression == Compression::Fast {
            // Otherwise zstd derives both from the chunk length, and with them its memory: a longer
            // chunk would reallocate all of it.
            zstd.set_parameter(CParameter::WindowLog(17))?;
            zstd.set_parameter(CParameter::HashLog(13))?;
        }
        Ok(Self(zstd))
    }

    /// Appends one frame. Equal input gives equal frames.
    pub(crate) fn compress(&mut self, bytes: &[u8], out: &mut Vec<u8>) -> io::Result<()> {
        out.reserve(compress_bound(bytes.len()));
        let end = out.len() as u64;
        let mut cursor = Cursor::new(out);
        cursor.set_position(end);
        self.0.compress_to_buffer(bytes, &mut cursor).map(drop)
    }
}
