//! Compression of pages.

use std::io::{self, Read};

use brotli_decompressor::{BrotliDecompressStream, BrotliResult, BrotliState, StandardAlloc};
use lz4_flex::block;

use super::fault::ParquetFault;
use crate::compression::{lz4_frames, zstd_frames};

/// Unpacks data to `size` bytes, whatever the data would expand to.
pub(super) fn unpack(codec: i64, data: &[u8], size: usize) -> Result<Vec<u8>, ParquetFault> {
    let name = match codec {
        0 => "UNCOMPRESSED",
        1 => "SNAPPY",
        2 => "GZIP",
        4 => "BROTLI",
        5 => "LZ4",
        6 => "ZSTD",
        7 => "LZ4_RAW",
        3 => return Err(ParquetFault::new("the compression LZO is not supported")),
        _ => return Err(ParquetFault::new(format!("the compression {codec} is unknown"))),
    };
    match unpack_up_to(codec, data, size) {
        Ok(unpacked) if unpacked.len() == size => Ok(unpacked),
        Ok(_) => {
            let message = format!("{name} data unpack to another length than {size} bytes");
            Err(ParquetFault::new(message))
        }
        Err(error) => Err(ParquetFault::new(format!("damaged {name} data: {error}"))),
    }
}

/// Unpacks at most one byte more than `size`, to notice longer data.
fn unpack_up_to(codec: i64, data: &[u8], size: usize) -> io::Result<Vec<u8>> {
    match codec {
        1 => snappy(data, size),
        2 => limited(flate2::read::MultiGzDecoder::new(data), size),
        4 => brotli(data, size),
        5 => lz4(data, size),
        6 => zstd_frames(data, size),
        7 => lz4_block(data, size),
        _ => limited(data, size),
    }
}

/// Reads at most one byte more than `size`.
fn limited(stream: impl Read, size: usize) -> io::Result<Vec<u8>> {
    let mut unpacked = Vec::with_capacity(size + 1);
    stream.take(size as u64 + 1).read_to_end(&mut unpacked)?;
    Ok(unpacked)
}

fn snappy(data: &[u8], size: usize) -> io::Result<Vec<u8>> {
    let length = snap::raw::decompress_len(data)?;
    if length != size {
        return Err(io::Error::other(format!("{length} bytes, not {size}")));
    }
    Ok(snap::raw::Decoder::new().decompress_vec(data)?)
}

/// Unpacks with a window of at most 16 MiB: larger ones, of 1 GiB, are an extension that is not
/// part of the format.
fn brotli(data: &[u8], size: usize) -> io::Result<Vec<u8>> {
    let allocator = StandardAlloc::default;
    let mut state = BrotliState::new_strict(allocator(), allocator(), allocator());
    let mut unpacked = vec![0; size];
    let (mut input, mut room) = (data.len(), size);
    let (mut read, mut written, mut total) = (0, 0, 0);
    let result = BrotliDecompressStream(
        &mut input,
        &mut read,
        data,
        &mut room,
        &mut written,
        &mut unpacked,
        &mut total,
        &mut state,
    );
    match result {
        BrotliResult::ResultSuccess => {
            unpacked.truncate(written);
            Ok(unpacked)
        }
        BrotliResult::NeedsMoreOutput => Err(io::Error::other("longer than stated")),
        BrotliResult::NeedsMoreInput => Err(io::ErrorKind::UnexpectedEof.into()),
        BrotliResult::ResultFailure => Err(io::ErrorKind::InvalidData.into()),
    }
}

fn lz4_block(data: &[u8], size: usize) -> io::Result<Vec<u8>> {
    let mut unpacked = vec![0; size];
    let length = block::decompress_into(data, &mut unpacked).map_err(io::Error::other)?;
    unpacked.truncate(length);
    Ok(unpacked)
}

/// Unpacks the codec LZ4, which different programs have written in the framing of Hadoop, as frames
/// and as a block.
fn lz4(data: &[u8], size: usize) -> io::Result<Vec<u8>> {
    if let Some(unpacked) = hadoop(data, size) {
        return Ok(unpacked);
    }
    if data.starts_with(&[0x04, 0x22, 0x4d, 0x18]) {
        return lz4_frames(data, size);
    }
    lz4_block(data, size)
}

/// Unpacks blocks that each follow their unpacked and packed length, big-endian.
fn hadoop(mut data: &[u8], size: usize) -> Option<Vec<u8>> {
    let mut unpacked = Vec::new();
    while let Some((&[a, b, c, d, e, f, g, h], rest)) = data.split_first_chunk() {
        let length = u32::from_be_bytes([a, b, c, d]) as usize;
        let packed = u32::from_be_bytes([e, f, g, h]) as usize;
        let (block, rest) = rest.split_at_checked(packed)?;
        if length > size - unpacked.len() {
            return None;
        }
        unpacked.extend(lz4_block(block, length).ok().filter(|block| block.len() == length)?);
        data = rest;
    }
    (data.is_empty() && unpacked.len() == size).then_some(unpacked)
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut stream = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        stream.write_all(bytes).unwrap();
        stream.finish().unwrap()
    }

    /// 30 000 000 zeros, compressed by the reference implementation of Brotli.
    const BROTLI: [u8; 51] = [
        203, 255, 255, 63, 0, 36, 0, 226, 177, 64, 114, 239, 255, 248, 255, 255, 7, 128, 4, 64, 28,
        22, 128, 238, 253, 31, 255, 255, 255, 0, 144, 0, 136, 195, 2, 208, 189, 255, 203, 191, 225,
        36, 0, 18, 0, 113, 88, 0, 58, 187, 73,
    ];

    /// Writes a frame of zeros: blocks that repeat a byte, in a window of 128 KiB.
    fn zstd(zeros: u32) -> Vec<u8> {
        const BLOCK: u32 = 1 << 17;
        let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0, 7 << 3];
        for start in (0..zeros).step_by(BLOCK as usize) {
            let length = BLOCK.min(zeros - start);
            let is_last = u32::from(start + length == zeros);
            frame.extend(&(length << 3 | 1 << 1 | is_last).to_le_bytes()[..3]);
            frame.push(0);
        }
        frame
    }

    #[test]
    fn no_more_is_unpacked_than_the_stated_length() {
        let zeros = vec![0; 30_000_000];
        let snappy = snap::raw::Encoder::new().compress_vec(&zeros).unwrap();
        let frames = {
            let mut stream = lz4_flex::frame::FrameEncoder::new(Vec::new());
            stream.write_all(&zeros).unwrap();
            stream.finish().unwrap()
        };
        let block = block::compress(&zeros);
        for (codec, packed) in [
            (0, zeros.clone()),
            (1, snappy),
            (2, gzip(&zeros)),
            (4, BROTLI.to_vec()),
            (5, frames),
            (5, block.clone()),
            (6, zstd(30_000_000)),
            (7, block),
        ] {
            assert!(codec == 0 || packed.len() < 2_000_000, "{codec}");
            if let Ok(unpacked) = unpack_up_to(codec, &packed, 1000) {
                assert!(unpacked.len() <= 1001, "{codec}: {} bytes", unpacked.len());
            }
            assert_eq!(unpack(codec, &packed, zeros.len()).unwrap(), zeros, "{codec}");
            for size in [0, 1000, zeros.len() - 1, zeros.len() + 1] {
                let error = unpack(codec, &packed, size).unwrap_err();
                assert!(!error.to_string().is_empty());
            }
        }
        assert!(unpack(0, &zeros, 100).is_err());
        assert!(unpack(3, &[], 0).unwrap_err().to_string().contains("LZO"));
        assert!(unpack(8, &[], 0).unwrap_err().to_string().contains("8 is unknown"));
    }

    #[test]
    fn lz4_has_the_framing_of_hadoop() {
        let text = b"joint joint joint joint joint joint";
        let mut framed = Vec::new();
        for part in [&text[..20], &text[20..]] {
            let block = block::compress(part);
            framed.extend(u32::try_from(part.len()).unwrap().to_be_bytes());
            framed.extend(u32::try_from(block.len()).unwrap().to_be_bytes());
            framed.extend(block);
        }
        assert_eq!(unpack(5, &framed, text.len()).unwrap(), text);
    }
}
