//! Compressing the chunks of a file.

use std::io::{self, Cursor};

use zstd::bulk;
use zstd::zstd_safe::{CParameter, compress_bound};

/// How a file is compressed: always with zstd, which every reader of MCAP knows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Compression {
    /// For files that someone waits for: what a plan is written with.
    Fast,
    /// For files that grow for hours: a plan would be a tenth smaller, and take more than twice as long to
    /// compress. What a recording is written with.
    #[default]
    Small,
}

impl Compression {
    /// The name in a chunk.
    pub(crate) const NAME: &str = "zstd";

    /// The level, as zstd counts. Joint values hardly compress further than at the lowest of the
    /// positive ones. Below zero, zstd leaves literals as they are and makes longer steps.
    fn level(self) -> i32 {
        match self {
            Self::Fast => -4,
            Self::Small => 1,
        }
    }

    /// Bytes of a chunk before compression: with fewer, all that a chunk needs stays in the
    /// processor's cache; with more, the index is shorter.
    pub(crate) fn chunk_bytes(self) -> usize {
        match self {
            Self::Fast => 128 * 1024,
            Self::Small => 1024 * 1024,
        }
    }
}

/// Compresses one chunk after the other, with memory that it keeps.
pub(crate) struct Compressor(bulk::Compressor<'static>);

impl Compressor {
    pub(crate) fn new(compression: Compression) -> io::Result<Self> {
        let mut zstd = bulk::Compressor::new(compression.level())?;
        if compression == Compression::Fast {
            // Otherwise they follow the length of the chunk, and with them the memory: a longer one would
            // have all of it given back and asked for anew.
            zstd.set_parameter(CParameter::WindowLog(17))?;
            zstd.set_parameter(CParameter::HashLog(13))?;
        }
        Ok(Self(zstd))
    }

    /// Appends one frame. The same bytes always give the same frame.
    pub(crate) fn compress(&mut self, bytes: &[u8], out: &mut Vec<u8>) -> io::Result<()> {
        out.reserve(compress_bound(bytes.len()));
        let end = out.len() as u64;
        let mut cursor = Cursor::new(out);
        cursor.set_position(end);
        self.0.compress_to_buffer(bytes, &mut cursor).map(drop)
    }
}
