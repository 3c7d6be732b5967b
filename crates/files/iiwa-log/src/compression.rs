//! Chunk compression.

use std::io::{self, Read, Write};

use lz4_flex::frame::{BlockMode, BlockSize, FrameDecoder, FrameEncoder, FrameInfo};
use mcap::McapError;
use mcap::records::ChunkHeader;
use ruzstd::decoding::StreamingDecoder;

/// Name in a chunk of the method that files are written with. Files are 3 to 7 % larger than at the
/// fast levels of zstd, and 17 to 29 % larger than at its level 1; the compressor is Rust, and
/// compiles in a second.
pub(crate) const METHOD: &str = "lz4";

/// Compresses one chunk after the other, and reuses its memory.
pub(crate) struct Compressor(FrameEncoder<Vec<u8>>);

impl Compressor {
    pub(crate) fn new() -> Self {
        let info =
            FrameInfo::new().block_mode(BlockMode::Independent).block_size(BlockSize::Max256KB);
        Self(FrameEncoder::with_frame_info(info, Vec::new()))
    }

    /// Appends one frame. Equal input gives equal frames.
    pub(crate) fn compress(&mut self, bytes: &[u8], out: &mut Vec<u8>) -> io::Result<()> {
        std::mem::swap(self.0.get_mut(), out);
        let done = self.0.write_all(bytes).and_then(|()| Ok(self.0.try_finish()?));
        std::mem::swap(self.0.get_mut(), out);
        done
    }
}

/// Replaces `records` by the records of a chunk, and verifies their length and checksums.
///
/// # Errors
///
/// An unknown method, damaged data, or more than `limit_bytes` of records. No more than the stated
/// length is unpacked, whatever the data would expand to.
pub(crate) fn decompress(
    chunk: &ChunkHeader,
    data: &[u8],
    limit_bytes: usize,
    records: &mut Vec<u8>,
) -> Result<(), McapError> {
    records.clear();
    let length = usize::try_from(chunk.uncompressed_size)
        .ok()
        .filter(|length| *length <= limit_bytes)
        .ok_or(McapError::ChunkTooLarge(chunk.uncompressed_size))?;
    let add_frame = match chunk.compression.as_str() {
        "" => copy,
        METHOD => add_lz4,
        "zstd" => add_zstd,
        other => return Err(McapError::UnsupportedCompression(other.to_owned())),
    };
    add_frames(data, length, records, add_frame).map_err(damaged)?;
    if records.len() != length {
        return Err(damaged(format!("unpacked to another length than {length} bytes")));
    }
    match chunk.uncompressed_crc {
        // A chunk without a checksum.
        0 => Ok(()),
        saved => {
            let calculated = crc32fast::hash(records);
            if saved == calculated {
                Ok(())
            } else {
                Err(McapError::BadChunkCrc { saved, calculated })
            }
        }
    }
}

/// Unpacks LZ4 frames, up to one byte more than `length`.
#[cfg(feature = "parquet")]
pub(crate) fn lz4_frames(data: &[u8], length: usize) -> io::Result<Vec<u8>> {
    let mut unpacked = Vec::with_capacity(length + 1);
    add_frames(data, length, &mut unpacked, add_lz4)?;
    Ok(unpacked)
}

/// Unpacks zstd frames, up to one byte more than `length`.
#[cfg(feature = "parquet")]
pub(crate) fn zstd_frames(data: &[u8], length: usize) -> io::Result<Vec<u8>> {
    let mut unpacked = Vec::with_capacity(length + 1);
    add_frames(data, length, &mut unpacked, add_zstd)?;
    Ok(unpacked)
}

/// Appends the content of one frame after the other; at most one byte more than `length`.
fn add_frames(
    mut data: &[u8],
    length: usize,
    records: &mut Vec<u8>,
    add_frame: fn(&mut &[u8], u64, &mut Vec<u8>) -> io::Result<()>,
) -> io::Result<()> {
    while !data.is_empty() && records.len() <= length {
        if let Some(rest) = after_skippable_frame(data) {
            data = rest;
            continue;
        }
        // One byte more, to notice longer data.
        let room = length - records.len() + 1;
        add_frame(&mut data, room as u64, records)?;
    }
    Ok(())
}

fn damaged(reason: impl std::fmt::Display) -> McapError {
    McapError::DecompressionError(reason.to_string())
}

/// Returns the data after a frame that LZ4 and zstd skip, if `data` begins with one.
fn after_skippable_frame(data: &[u8]) -> Option<&[u8]> {
    let (magic, rest) = data.split_first_chunk()?;
    let (length, rest) = rest.split_first_chunk()?;
    (0x184d_2a50..=0x184d_2a5f).contains(&u32::from_le_bytes(*magic)).then_some(())?;
    rest.get(usize::try_from(u32::from_le_bytes(*length)).ok()?..)
}

fn copy(data: &mut &[u8], room: u64, records: &mut Vec<u8>) -> io::Result<()> {
    std::mem::take(data).take(room).read_to_end(records).map(drop)
}

/// Appends the content of the LZ4 frame at the start of `data`, and moves `data` behind it.
fn add_lz4(data: &mut &[u8], room: u64, records: &mut Vec<u8>) -> io::Result<()> {
    FrameDecoder::new(data).take(room).read_to_end(records).map(drop)
}

/// Appends the content of the zstd frame at the start of `data`, and moves `data` behind it.
fn add_zstd(data: &mut &[u8], room: u64, records: &mut Vec<u8>) -> io::Result<()> {
    let mut frame = StreamingDecoder::new(data).map_err(io::Error::other)?;
    (&mut frame).take(room).read_to_end(records)?;
    let decoder = &frame.decoder;
    match (decoder.get_checksum_from_data(), decoder.get_calculated_checksum()) {
        (Some(saved), Some(calculated)) if saved != calculated => {
            Err(io::Error::other("the checksum of a zstd frame differs"))
        }
        _ => Ok(()),
    }
}
