//! Tail of an MCAP file: everything after its messages.

use std::ops::Range;

use mcap::records::{
    AttachmentIndex, ChunkIndex, DataEnd, Footer, MetadataIndex, Statistics, SummaryOffset, op,
};
use mcap::{MAGIC, McapError};

use crate::Topic;
use crate::record::{RECORD_HEADER_BYTES, put_channel, put_record, put_schema};

/// Bytes of the footer content: two offsets and a checksum.
const FOOTER_CONTENT_BYTES: usize = 20;

/// Bytes of the footer and the following magic, at the end of every file.
pub(crate) const FOOTER_BYTES: usize = RECORD_HEADER_BYTES + FOOTER_CONTENT_BYTES + MAGIC.len();

/// Range of the content in the bytes of the footer.
pub(crate) const FOOTER_CONTENT: Range<usize> =
    RECORD_HEADER_BYTES..RECORD_HEADER_BYTES + FOOTER_CONTENT_BYTES;

/// Range of the checksum in the bytes of the footer.
pub(crate) const FOOTER_CRC: Range<usize> = FOOTER_CONTENT.end - 4..FOOTER_CONTENT.end;

/// Summary of a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Index {
    statistics: Statistics,
    /// Encoded records: a chunk index is written into many tails.
    chunks: Vec<u8>,
    attachments: Vec<u8>,
    metadata: Vec<u8>,
}

impl Index {
    /// Adds a chunk with `counts` messages per topic.
    pub(crate) fn chunk(
        &mut self,
        chunk: &ChunkIndex,
        counts: &[u64; Topic::ALL.len()],
    ) -> Result<(), McapError> {
        let all = &mut self.statistics;
        let first = all.chunk_count == 0;
        all.message_start_time = if first {
            chunk.message_start_time
        } else {
            all.message_start_time.min(chunk.message_start_time)
        };
        all.message_end_time = all.message_end_time.max(chunk.message_end_time);
        all.chunk_count += 1;
        for (topic, &count) in Topic::ALL.into_iter().zip(counts).filter(|(_, count)| **count > 0) {
            *all.channel_message_counts.entry(topic.id()).or_default() += count;
            all.message_count += count;
        }
        put_record(&mut self.chunks, op::CHUNK_INDEX, chunk)
    }

    /// Adds an attachment.
    pub(crate) fn attachment(&mut self, attachment: &AttachmentIndex) -> Result<(), McapError> {
        self.statistics.attachment_count += 1;
        put_record(&mut self.attachments, op::ATTACHMENT_INDEX, attachment)
    }

    /// Adds a metadata record.
    pub(crate) fn metadata(&mut self, metadata: &MetadataIndex) -> Result<(), McapError> {
        self.statistics.metadata_count += 1;
        put_record(&mut self.metadata, op::METADATA_INDEX, metadata)
    }

    /// Encodes the tail of a file whose data section ends at `data_end` and has this checksum; 0
    /// omits the checksum.
    pub(crate) fn tail(&self, data_end: u64, data_section_crc: u32) -> Result<Vec<u8>, McapError> {
        let counts = &self.statistics.channel_message_counts;
        let topics = || Topic::ALL.into_iter().filter(|topic| counts.contains_key(&topic.id()));
        let statistics = Statistics {
            schema_count: u16::try_from(counts.len()).unwrap_or(u16::MAX),
            channel_count: u32::try_from(counts.len()).unwrap_or(u32::MAX),
            ..self.statistics.clone()
        };

        let mut tail = Vec::with_capacity(self.chunks.len() + 16 * 1024);
        put_record(&mut tail, op::DATA_END, &DataEnd { data_section_crc })?;
        let summary = tail.len();
        let mut offsets = Vec::new();
        let mut from = summary;
        let mut group = |tail: &[u8], opcode| {
            if tail.len() > from {
                offsets.push(SummaryOffset {
                    group_opcode: opcode,
                    group_start: data_end + from as u64,
                    group_length: (tail.len() - from) as u64,
                });
            }
            from = tail.len();
        };

        for topic in topics() {
            put_schema(&mut tail, topic)?;
        }
        group(&tail, op::SCHEMA);
        for topic in topics() {
            put_channel(&mut tail, topic)?;
        }
        group(&tail, op::CHANNEL);
        put_record(&mut tail, op::STATISTICS, &statistics)?;
        group(&tail, op::STATISTICS);
        let indexes = [
            (op::CHUNK_INDEX, &self.chunks),
            (op::ATTACHMENT_INDEX, &self.attachments),
            (op::METADATA_INDEX, &self.metadata),
        ];
        for (opcode, records) in indexes {
            tail.extend(records);
            group(&tail, opcode);
        }
        let offsets_at = tail.len();
        for offset in &offsets {
            put_record(&mut tail, op::SUMMARY_OFFSET, offset)?;
        }

        let mut footer = Footer {
            summary_start: data_end + summary as u64,
            summary_offset_start: data_end + offsets_at as u64,
            summary_crc: 0,
        };
        let start = tail.len();
        put_record(&mut tail, op::FOOTER, &footer)?;
        // The checksum covers the footer up to the checksum itself.
        footer.summary_crc = crc32fast::hash(&tail[summary..start + FOOTER_CRC.start]);
        tail.truncate(start);
        put_record(&mut tail, op::FOOTER, &footer)?;
        tail.extend(MAGIC);
        Ok(tail)
    }
}
