//! Files compressed by the `mcap` crate with each of its methods, and chunks whose header is wrong.

use std::io::Cursor;

use iiwa_log::{ReadError, Recording};
use mcap::{Compression, McapError, MessageStream, WriteOptions, records::op};

use crate::recording::sample::sample;

/// Returns the messages of `file` in a file of the `mcap` crate, in one chunk.
fn rewritten(file: &[u8], method: Option<Compression>) -> Vec<u8> {
    let options = WriteOptions::new().compression(method).chunk_size(None);
    let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
    for message in MessageStream::new(file).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

/// Offset of the content of the first chunk.
fn chunk_offset(file: &[u8]) -> usize {
    let mut offset = mcap::MAGIC.len();
    loop {
        let length = u64::from_le_bytes(file[offset + 1..offset + 9].try_into().unwrap());
        if file[offset] == op::CHUNK {
            return offset + 9;
        }
        offset += 9 + usize::try_from(length).unwrap();
    }
}

/// Returns the error of a file whose chunk header is changed.
fn with_chunk(method: Compression, change: impl Fn(&mut [u8])) -> McapError {
    let mut file = rewritten(&sample(), Some(method));
    let offset = chunk_offset(&file);
    change(&mut file[offset..]);
    let error = Recording::from_bytes(&file).unwrap_err();
    let ReadError::Mcap { source, .. } = error else { unreachable!("{error:?}") };
    source
}

/// Writes the length after unpacking, which follows the two times.
fn claim(bytes: u64) -> impl Fn(&mut [u8]) {
    move |chunk| chunk[16..24].copy_from_slice(&bytes.to_le_bytes())
}

#[test]
fn every_method_of_mcap_is_read() {
    let expected = Recording::from_bytes(&sample()).unwrap();
    for method in [None, Some(Compression::Lz4), Some(Compression::Zstd)] {
        let read = Recording::from_bytes(&rewritten(&sample(), method)).unwrap();
        assert_eq!(read.joint_states, expected.joint_states, "{method:?}");
        assert_eq!(read.tcp_poses, expected.tcp_poses, "{method:?}");
    }
}

#[test]
fn no_more_is_unpacked_than_the_chunk_states() {
    for method in [Compression::Lz4, Compression::Zstd] {
        for bytes in [0, 100, 1 << 24] {
            let error = with_chunk(method, claim(bytes));
            assert!(matches!(error, McapError::DecompressionError(_)), "{bytes}: {error:?}");
        }
        let error = with_chunk(method, claim(1 << 40));
        assert!(matches!(error, McapError::ChunkTooLarge(bytes) if bytes == 1 << 40), "{error:?}");
    }
}

#[test]
fn a_chunk_of_an_unknown_method_or_with_another_checksum_is_an_error() {
    let other_method = |chunk: &mut [u8]| chunk[32..35].copy_from_slice(b"xz5");
    let error = with_chunk(Compression::Lz4, other_method);
    assert!(
        matches!(&error, McapError::UnsupportedCompression(name) if name == "xz5"),
        "{error:?}"
    );
    let error = with_chunk(Compression::Lz4, |chunk| chunk[24] ^= 1);
    assert!(matches!(error, McapError::BadChunkCrc { .. }), "{error:?}");
}

/// Replaces the data of the chunk, which has no compression, by `data` of this method.
fn packed(method: &str, pack: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    let file = rewritten(&sample(), None);
    let offset = chunk_offset(&file);
    let length = u64::from_le_bytes(file[offset - 8..offset].try_into().unwrap());
    let chunk = &file[offset..offset + usize::try_from(length).unwrap()];
    // Two times, length and checksum; the name of the method, which is empty; data with its length.
    let data = pack(&chunk[40..]);
    let mut content = chunk[..28].to_vec();
    content.extend(u32::try_from(method.len()).unwrap().to_le_bytes());
    content.extend(method.as_bytes());
    content.extend((data.len() as u64).to_le_bytes());
    content.extend(data);
    let mut out = file[..offset - 8].to_vec();
    out.extend((content.len() as u64).to_le_bytes());
    out.extend(content);
    out
}

#[test]
fn chunks_of_several_frames_are_read() {
    let skippable = [&0x184d_2a53_u32.to_le_bytes()[..], &3_u32.to_le_bytes(), b"abc"].concat();
    let lz4 = |bytes: &[u8]| {
        let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
        std::io::Write::write_all(&mut encoder, bytes).unwrap();
        encoder.finish().unwrap()
    };
    let zstd = |bytes: &[u8]| {
        ruzstd::encoding::compress_to_vec(bytes, ruzstd::encoding::CompressionLevel::Uncompressed)
    };
    let frames = |pack: &dyn Fn(&[u8]) -> Vec<u8>, bytes: &[u8]| {
        let (first, second) = bytes.split_at(bytes.len() / 2);
        [&skippable[..], &pack(&[]), &pack(first), &skippable, &pack(second)].concat()
    };
    let expected = Recording::from_bytes(&sample()).unwrap().joint_states;
    for (method, file) in [
        ("lz4", packed("lz4", |bytes| frames(&lz4, bytes))),
        ("zstd", packed("zstd", |bytes| frames(&zstd, bytes))),
    ] {
        // The file ends behind the chunk.
        let entries = iiwa_log::Reader::new(&*file).filter_map(Result::ok);
        let states: Vec<_> = entries
            .filter_map(|entry| match entry {
                iiwa_log::Entry::JointState(state) => Some(state),
                _ => None,
            })
            .collect();
        assert_eq!(states, expected, "{method}");
    }
}
