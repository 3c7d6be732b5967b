//! The end of an MCAP file, from the end of its messages on, at any time.
//!
//! The `mcap` crate writes it once, when a file is finished.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::ops::Range;

use binrw::{BinWrite, BinWriterExt};
use mcap::records::{
    Channel, ChunkHeader, ChunkIndex, DataEnd, Footer, Record, SchemaHeader, Statistics,
    SummaryOffset, op,
};
use mcap::{MAGIC, McapError};

use crate::Topic;
use crate::writer::channel_metadata;

/// Type and length of a record, before its content.
pub(crate) const RECORD_HEADER_BYTES: usize = 9;

/// The footer's content: two offsets and a checksum.
const FOOTER_CONTENT_BYTES: usize = 20;

/// The footer and the magic after it, at the end of every file.
pub(crate) const FOOTER_BYTES: usize = RECORD_HEADER_BYTES + FOOTER_CONTENT_BYTES + MAGIC.len();

/// The footer's content, as a place in its bytes.
pub(crate) const FOOTER_CONTENT: Range<usize> =
    RECORD_HEADER_BYTES..RECORD_HEADER_BYTES + FOOTER_CONTENT_BYTES;

/// The checksum in the footer, as a place in its bytes.
pub(crate) const FOOTER_CRC: Range<usize> = FOOTER_CONTENT.end - 4..FOOTER_CONTENT.end;

/// What the summary of a file says about its messages.
#[derive(Clone, Debug, Default)]
pub(crate) struct Index {
    statistics: Statistics,
    /// The records, as they stand in the file: a chunk is written into many tails.
    chunks: Vec<u8>,
}

impl Index {
    /// Takes up whole records that stand at `offset` in the file.
    pub(crate) fn take(&mut self, offset: u64, bytes: &[u8]) -> Result<(), McapError> {
        let mut at = if offset == 0 { MAGIC.len() } else { 0 };
        let mut chunk: Option<ChunkIndex> = None;
        while let Some((opcode, content)) = record_at(bytes, at) {
            let start = offset + at as u64;
            at = content.end;
            let length = offset + at as u64 - start;
            match mcap::parse_record(opcode, &bytes[content])? {
                Record::Chunk { header, .. } => {
                    if let Some(before) = chunk.replace(chunk_index(start, length, header)) {
                        self.push(&before)?;
                    }
                }
                Record::MessageIndex(index) => {
                    if let Some(chunk) = &mut chunk {
                        chunk.message_index_offsets.insert(index.channel_id, start);
                        chunk.message_index_length += length;
                    }
                    let count = index.records.len() as u64;
                    let counts = &mut self.statistics.channel_message_counts;
                    *counts.entry(index.channel_id).or_default() += count;
                    self.statistics.message_count += count;
                }
                _ => {}
            }
        }
        match chunk {
            Some(chunk) => self.push(&chunk),
            None => Ok(()),
        }
    }

    fn push(&mut self, chunk: &ChunkIndex) -> Result<(), McapError> {
        let all = &mut self.statistics;
        let first = all.chunk_count == 0;
        all.message_start_time = if first {
            chunk.message_start_time
        } else {
            all.message_start_time.min(chunk.message_start_time)
        };
        all.message_end_time = all.message_end_time.max(chunk.message_end_time);
        all.chunk_count += 1;
        record(&mut self.chunks, op::CHUNK_INDEX, chunk)
    }

    /// The tail of a file whose data section ends at `data_end`: as `mcap` writes it, but for the
    /// checksum of the data section, which is left out.
    pub(crate) fn tail(&self, data_end: u64) -> Result<Vec<u8>, McapError> {
        let counts = &self.statistics.channel_message_counts;
        let topics = || Topic::ALL.into_iter().filter(|topic| counts.contains_key(&topic.id()));
        let statistics = Statistics {
            schema_count: u16::try_from(counts.len()).unwrap_or(u16::MAX),
            channel_count: u32::try_from(counts.len()).unwrap_or(u32::MAX),
            ..self.statistics.clone()
        };

        let mut tail = Vec::with_capacity(self.chunks.len() + 16 * 1024);
        record(&mut tail, op::DATA_END, &DataEnd::default())?;
        let summary = tail.len();
        let mut offsets = Vec::new();
        let mut group = |tail: &[u8], from: &mut usize, opcode| {
            offsets.push(SummaryOffset {
                group_opcode: opcode,
                group_start: data_end + *from as u64,
                group_length: (tail.len() - *from) as u64,
            });
            *from = tail.len();
        };

        let mut from = summary;
        for topic in topics() {
            schema(&mut tail, topic)?;
        }
        group(&tail, &mut from, op::SCHEMA);
        for topic in topics() {
            let channel = Channel {
                id: topic.id(),
                schema_id: topic.id(),
                topic: topic.name().to_owned(),
                message_encoding: Topic::MESSAGE_ENCODING.to_owned(),
                metadata: channel_metadata(topic),
            };
            record(&mut tail, op::CHANNEL, &channel)?;
        }
        group(&tail, &mut from, op::CHANNEL);
        record(&mut tail, op::STATISTICS, &statistics)?;
        group(&tail, &mut from, op::STATISTICS);
        tail.extend(&self.chunks);
        group(&tail, &mut from, op::CHUNK_INDEX);
        for offset in &offsets {
            record(&mut tail, op::SUMMARY_OFFSET, offset)?;
        }

        let mut footer = Footer {
            summary_start: data_end + summary as u64,
            summary_offset_start: data_end + from as u64,
            summary_crc: 0,
        };
        let start = tail.len();
        record(&mut tail, op::FOOTER, &footer)?;
        // The checksum covers the footer up to itself.
        footer.summary_crc = crc32fast::hash(&tail[summary..start + FOOTER_CRC.start]);
        tail.truncate(start);
        record(&mut tail, op::FOOTER, &footer)?;
        tail.extend(MAGIC);
        Ok(tail)
    }
}

/// The entry of a chunk, without its message indexes.
fn chunk_index(start: u64, length: u64, header: ChunkHeader) -> ChunkIndex {
    ChunkIndex {
        message_start_time: header.message_start_time,
        message_end_time: header.message_end_time,
        chunk_start_offset: start,
        chunk_length: length,
        message_index_offsets: BTreeMap::new(),
        message_index_length: 0,
        compression: header.compression,
        compressed_size: header.compressed_size,
        uncompressed_size: header.uncompressed_size,
    }
}

/// Type and content of the record that begins at `at`, if there is a whole one.
fn record_at(bytes: &[u8], at: usize) -> Option<(u8, Range<usize>)> {
    let (opcode, rest) = bytes.get(at..)?.split_first()?;
    let length = usize::try_from(u64::from_le_bytes(*rest.first_chunk()?)).ok()?;
    let start = at + RECORD_HEADER_BYTES;
    let content = start..start.checked_add(length)?;
    bytes.get(content.clone()).map(|_| (*opcode, content))
}

fn schema(out: &mut Vec<u8>, topic: Topic) -> Result<(), McapError> {
    let header = SchemaHeader {
        id: topic.id(),
        name: topic.type_name().to_owned(),
        encoding: Topic::SCHEMA_ENCODING.to_owned(),
    };
    let text = topic.schema();
    let length = u32::try_from(text.len()).unwrap_or(u32::MAX);
    let mut content = Cursor::new(Vec::new());
    content.write_le(&header)?;
    content.write_le(&length)?;
    let mut content = content.into_inner();
    content.extend(text.as_bytes());
    put(out, op::SCHEMA, &content);
    Ok(())
}

/// Appends a record.
fn record<T>(out: &mut Vec<u8>, opcode: u8, content: &T) -> Result<(), McapError>
where
    T: for<'a> BinWrite<Args<'a> = ()>,
{
    let mut bytes = Cursor::new(Vec::new());
    bytes.write_le(content)?;
    put(out, opcode, bytes.get_ref());
    Ok(())
}

fn put(out: &mut Vec<u8>, opcode: u8, content: &[u8]) {
    out.extend(record_header(opcode, content.len() as u64));
    out.extend(content);
}

/// Type and length of a record.
pub(crate) fn record_header(opcode: u8, length: u64) -> [u8; RECORD_HEADER_BYTES] {
    let mut header = [opcode; RECORD_HEADER_BYTES];
    header[1..].copy_from_slice(&length.to_le_bytes());
    header
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::{Config, Writer};

    /// Cross-validated against the tail that the `mcap` crate writes itself.
    #[test]
    fn the_tail_is_the_one_of_mcap() {
        let mut writer = Writer::new(Cursor::new(Vec::new()), Config::default()).unwrap();
        writer.robot_description(Duration::ZERO, "<robot/>").unwrap();
        for tick in 0..20_000 {
            let t = Duration::from_millis(tick);
            writer.joint_state(t, &[t.as_secs_f64(); 7], &[1.0; 7]).unwrap();
            if tick % 7 == 0 {
                writer.tcp_pose(t, "iiwa_link_0", [0.0; 3], [0.0, 0.0, 0.0, 1.0]).unwrap();
            }
            if tick % 5000 == 4999 {
                writer.end_chunk().unwrap();
            }
        }
        let file = writer.finish().unwrap().into_inner();

        let footer = &file[file.len() - FOOTER_BYTES..][FOOTER_CONTENT];
        let summary = u64::from_le_bytes(*footer.first_chunk().unwrap());
        let data_end = usize::try_from(summary).unwrap() - RECORD_HEADER_BYTES - 4;
        let mut index = Index::default();
        // In two parts, as a recorder does it.
        let half = usize::try_from(chunks(&file)[2]).unwrap();
        index.take(0, &file[..half]).unwrap();
        index.take(half as u64, &file[half..data_end]).unwrap();
        let tail = index.tail(data_end as u64).unwrap();

        // The checksum of the data section.
        let crc = RECORD_HEADER_BYTES..RECORD_HEADER_BYTES + 4;
        assert_eq!(tail[crc.clone()], [0; 4]);
        assert_eq!(tail[..crc.start], file[data_end..][..crc.start]);
        assert!(tail[crc.end..] == file[data_end..][crc.end..]);
        assert!(index.statistics.chunk_count > 5);
    }

    /// Where the chunks begin.
    fn chunks(file: &[u8]) -> Vec<u64> {
        mcap::Summary::read(file)
            .unwrap()
            .unwrap()
            .chunk_indexes
            .iter()
            .map(|chunk| chunk.chunk_start_offset)
            .collect()
    }
}
