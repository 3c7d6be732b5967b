//! A chunk of messages under construction.

use std::collections::BTreeMap;

use mcap::McapError;
use mcap::records::{ChunkHeader, ChunkIndex, MessageHeader, MessageIndex, MessageIndexEntry, op};

use crate::Topic;
use crate::compression::{Compression, Compressor};
use crate::record::{
    MESSAGE_HEADER_BYTES, RECORD_HEADER_BYTES, append, message_header, put_channel, put_record,
    put_schema, record_header,
};

/// Memory that is kept for the next chunk, at most: a long trajectory takes tens of megabytes once.
const KEPT_BYTES: usize = 2 * 1024 * 1024;

/// The messages since the last chunk, with an index of each topic. It keeps its memory for the next.
#[derive(Debug)]
pub(crate) struct Chunk {
    bytes: Vec<u8>,
    indexes: [MessageIndex; Topic::ALL.len()],
    /// The earliest and the latest time.
    bounds: Option<(u64, u64)>,
    /// The chunk as it was written last.
    written: Vec<u8>,
}

/// A chunk as it goes into the file.
#[derive(Debug)]
pub(crate) struct FinishedChunk<'a> {
    /// Its record and those of its indexes.
    pub(crate) records: &'a [u8],
    /// What the summary says of it.
    pub(crate) index: ChunkIndex,
    /// Messages by topic.
    pub(crate) counts: [u64; Topic::ALL.len()],
}

impl Chunk {
    /// An empty one, with room for so many bytes.
    pub(crate) fn with_capacity(bytes: usize) -> Self {
        let indexes =
            Topic::ALL.map(|topic| MessageIndex { channel_id: topic.id(), records: Vec::new() });
        Self { bytes: Vec::with_capacity(bytes), indexes, bounds: None, written: Vec::new() }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Bytes with one more message of so many.
    pub(crate) fn len_with(&self, data_bytes: usize) -> usize {
        self.bytes.len() + MESSAGE_HEADER_BYTES + data_bytes
    }

    /// Defines the channel of a topic, which goes before its first message.
    pub(crate) fn define(&mut self, topic: Topic) -> Result<(), McapError> {
        put_schema(&mut self.bytes, topic)?;
        put_channel(&mut self.bytes, topic)
    }

    pub(crate) fn message(&mut self, topic: Topic, sequence: u32, time: u64, data: &[u8]) {
        self.header(topic, sequence, time, data.len());
        self.bytes.extend_from_slice(data);
    }

    /// The same for a message that may be a giant, whose memory it takes over.
    pub(crate) fn long_message(
        &mut self,
        topic: Topic,
        sequence: u32,
        time: u64,
        mut data: Vec<u8>,
    ) {
        self.header(topic, sequence, time, data.len());
        if data.len() > self.bytes.len() {
            data.splice(..0, self.bytes.drain(..));
            self.bytes = data;
        } else {
            self.bytes.extend(data);
        }
    }

    /// All of a message but its data.
    fn header(&mut self, topic: Topic, sequence: u32, time: u64, data_bytes: usize) {
        let entry = MessageIndexEntry { log_time: time, offset: self.bytes.len() as u64 };
        self.indexes[topic as usize].records.push(entry);
        let (first, last) = self.bounds.unwrap_or((time, time));
        self.bounds = Some((first.min(time), last.max(time)));
        let channel_id = topic.id();
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        self.bytes.extend_from_slice(&message_header(&header, data_bytes));
    }

    /// Compresses the messages into the records of a chunk at `offset` in the file, and starts a new one.
    pub(crate) fn finish(
        &mut self,
        offset: u64,
        compressor: &mut Compressor,
    ) -> Result<FinishedChunk<'_>, McapError> {
        let Self { bytes, indexes, bounds, written } = self;
        let (message_start_time, message_end_time) = bounds.take().unwrap_or_default();
        let mut header = ChunkHeader {
            message_start_time,
            message_end_time,
            uncompressed_size: bytes.len() as u64,
            uncompressed_crc: crc32fast::hash(bytes),
            compression: Compression::NAME.to_owned(),
            compressed_size: 0,
        };
        written.clear();
        written.shrink_to(KEPT_BYTES);
        put_record(written, op::CHUNK, &header)?;
        let messages_at = written.len();
        compressor.compress(bytes, written)?;
        bytes.clear();
        bytes.shrink_to(KEPT_BYTES);
        let chunk_length = written.len() as u64;

        // Now that the length is known.
        header.compressed_size = (written.len() - messages_at) as u64;
        let mut start =
            record_header(op::CHUNK, chunk_length - RECORD_HEADER_BYTES as u64).to_vec();
        append(&mut start, &header)?;
        written[..messages_at].copy_from_slice(&start);

        let mut index = ChunkIndex {
            message_start_time,
            message_end_time,
            chunk_start_offset: offset,
            chunk_length,
            message_index_offsets: BTreeMap::new(),
            message_index_length: 0,
            compression: header.compression,
            compressed_size: header.compressed_size,
            uncompressed_size: header.uncompressed_size,
        };
        let mut counts = [0; Topic::ALL.len()];
        for (messages, count) in indexes.iter_mut().zip(&mut counts) {
            if messages.records.is_empty() {
                continue;
            }
            *count = messages.records.len() as u64;
            let at = offset + written.len() as u64;
            index.message_index_offsets.insert(messages.channel_id, at);
            put_record(written, op::MESSAGE_INDEX, messages)?;
            messages.records.clear();
        }
        index.message_index_length = written.len() as u64 - chunk_length;
        Ok(FinishedChunk { records: written, index, counts })
    }
}
