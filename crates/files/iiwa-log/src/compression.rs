//! Chunk compression.

use std::{
    io::{self, Read, Write},
    ops::Range,
};

use lz4_flex::frame::{BlockMode, BlockSize, FrameDecoder, FrameEncoder, FrameInfo};
use mcap::McapError;
use mcap::records::ChunkHeader;
use ruzstd::decoding::StreamingDecoder;

use crate::message_blocks::{MessageStart, put_block};

/// Name in a chunk of the method that files are written with.
pub(crate) const METHOD: &str = "lz4";

/// Largest block of a frame, in bytes.
const MAX_BLOCK_BYTES: usize = 256 * 1024;

/// Records without an earlier message of their topic that are long enough for a block of their own,
/// in bytes: texts of schemas, and long messages.
const SEARCHED_BYTES: usize = 4096;

/// Bit of a block's length that marks uncompressed data.
const UNCOMPRESSED: u32 = 1 << 31;

/// Compresses chunks as LZ4 frames.
pub(crate) struct Compressor {
    /// Start of a frame.
    frame_header: Vec<u8>,
}

/// Part of a chunk that becomes one block of the frame.
#[derive(Debug)]
struct FrameBlock {
    bytes: Range<usize>,
    /// Starts of the messages in the block, by index.
    starts: Range<usize>,
    /// True if an earlier message of the topic precedes most messages.
    resembles: bool,
}

impl Compressor {
    pub(crate) fn new() -> io::Result<Self> {
        let info =
            FrameInfo::new().block_mode(BlockMode::Independent).block_size(BlockSize::Max256KB);
        let mut encoder = FrameEncoder::with_frame_info(info, Vec::new());
        encoder.write_all(&[0])?;
        encoder.try_finish()?;
        let mut frame_header = encoder.into_inner();
        frame_header.truncate(FRAME_HEADER_BYTES);
        Ok(Self { frame_header })
    }

    /// Appends a frame with a chunk; `starts` are the starts of its messages, in order. Equal input
    /// gives equal frames.
    #[expect(clippy::cast_possible_truncation, reason = "blocks have at most `MAX_BLOCK_BYTES`")]
    pub(crate) fn compress(&self, chunk: &[u8], starts: &[MessageStart], out: &mut Vec<u8>) {
        out.extend_from_slice(&self.frame_header);
        for FrameBlock { bytes, starts: within, resembles } in blocks(chunk.len(), starts) {
            let block = &chunk[bytes.clone()];
            let length_at = out.len();
            out.extend([0; BLOCK_LENGTH_BYTES]);
            let start = out.len();
            if resembles {
                put_block(chunk, bytes, &starts[within], out);
            } else {
                out.extend(lz4_flex::block::compress(block));
            }
            let mut length = (out.len() - start) as u32;
            if out.len() - start >= block.len() {
                out.truncate(start);
                out.extend_from_slice(block);
                length = block.len() as u32 | UNCOMPRESSED;
            }
            out[length_at..start].copy_from_slice(&length.to_le_bytes());
        }
        // End of the frame.
        out.extend([0; BLOCK_LENGTH_BYTES]);
    }
}

/// Bytes of the start of a frame: magic number, flags and checksum.
const FRAME_HEADER_BYTES: usize = 7;

/// Bytes of the length before each block.
const BLOCK_LENGTH_BYTES: usize = 4;

/// Divides a chunk of `length` bytes.
fn blocks(length: usize, starts: &[MessageStart]) -> Vec<FrameBlock> {
    let mut blocks: Vec<FrameBlock> = Vec::new();
    let mut first = 0;
    for group in starts.chunk_by(|a, b| a.previous.is_some() == b.previous.is_some()) {
        let starts_of = first..first + group.len();
        first = starts_of.end;
        let end = starts.get(first).map_or(length, |next| next.at);
        let bytes = group[0].at..end;
        let resembles = group[0].previous.is_some();
        match blocks.last_mut() {
            Some(last) if last.resembles && (resembles || bytes.len() < SEARCHED_BYTES) => {
                (last.bytes.end, last.starts.end) = (bytes.end, starts_of.end);
            }
            _ => blocks.push(FrameBlock { bytes, starts: starts_of, resembles }),
        }
    }
    blocks.into_iter().flat_map(|block| parts(block, starts)).collect()
}

/// Divides a block that is too long, between messages if possible.
fn parts(block: FrameBlock, starts: &[MessageStart]) -> Vec<FrameBlock> {
    let FrameBlock { bytes, starts: within, resembles } = block;
    let (mut at, mut first, mut parts) = (bytes.start, within.start, Vec::new());
    while at < bytes.end {
        let furthest = (at + MAX_BLOCK_BYTES).min(bytes.end);
        let rest = &starts[first..within.end];
        let fitting = rest.partition_point(|start| start.at <= furthest);
        let between = rest[..fitting].last().map(|start| start.at).filter(|start| *start > at);
        let end = if furthest == bytes.end { furthest } else { between.unwrap_or(furthest) };
        let next = first + rest.partition_point(|start| start.at < end);
        parts.push(FrameBlock { bytes: at..end, starts: first..next, resembles });
        (at, first) = (end, next);
    }
    parts
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
