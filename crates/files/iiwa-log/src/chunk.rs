//! A chunk of messages under construction.

use std::collections::BTreeMap;

use mcap::McapError;
use mcap::records::{ChunkHeader, ChunkIndex, MessageHeader, MessageIndex, MessageIndexEntry, op};

use crate::Topic;
use crate::compression::{self, Compressor};
use crate::message_blocks::{MAX_DISTANCE, MessageStart};
use crate::record::{
    MESSAGE_HEADER_BYTES, RECORD_HEADER_BYTES, append, message_header, put_channel, put_record,
    put_schema, record_header,
};

/// Upper bound on the memory kept for the next chunk: a long trajectory needs tens of megabytes
/// once.
const KEPT_BYTES: usize = 2 * 1024 * 1024;

/// Messages since the last chunk, with an index per topic. The buffers are reused for the next
/// chunk.
#[derive(Debug)]
pub(crate) struct Chunk {
    bytes: Vec<u8>,
    /// Starts of the messages, and of definitions of channels.
    starts: Vec<MessageStart>,
    /// Start of the last message of each topic.
    last: [Option<usize>; Topic::ALL.len()],
    indexes: [MessageIndex; Topic::ALL.len()],
    /// Earliest and latest log time.
    bounds: Option<(u64, u64)>,
    /// Records of the last written chunk.
    written: Vec<u8>,
}

/// Encoded chunk.
#[derive(Debug)]
pub(crate) struct FinishedChunk<'a> {
    /// Records of the chunk and its indexes.
    pub(crate) records: &'a [u8],
    /// Entry of the chunk in the summary.
    pub(crate) index: ChunkIndex,
    /// Number of messages per topic.
    pub(crate) counts: [u64; Topic::ALL.len()],
}

impl Chunk {
    /// Creates an empty chunk with this capacity in bytes.
    pub(crate) fn with_capacity(bytes: usize) -> Self {
        let indexes =
            Topic::ALL.map(|topic| MessageIndex { channel_id: topic.id(), records: Vec::new() });
        Self {
            bytes: Vec::with_capacity(bytes),
            starts: Vec::new(),
            last: Default::default(),
            indexes,
            bounds: None,
            written: Vec::new(),
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Size in bytes with one more message of `data_bytes`.
    pub(crate) fn len_with(&self, data_bytes: usize) -> usize {
        self.bytes.len() + MESSAGE_HEADER_BYTES + data_bytes
    }

    /// Defines the channel of a topic; must precede its first message.
    pub(crate) fn define(&mut self, topic: Topic) -> Result<(), McapError> {
        self.starts.push(MessageStart { at: self.bytes.len(), previous: None });
        put_schema(&mut self.bytes, topic)?;
        put_channel(&mut self.bytes, topic)
    }

    pub(crate) fn message(&mut self, topic: Topic, sequence: u32, time: u64, data: &[u8]) {
        self.header(topic, sequence, time, data.len());
        self.bytes.extend_from_slice(data);
    }

    /// Appends a message that may be very large, and reuses its buffer.
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

    /// Appends all of a message except its data.
    fn header(&mut self, topic: Topic, sequence: u32, time: u64, data_bytes: usize) {
        let entry = MessageIndexEntry { log_time: time, offset: self.bytes.len() as u64 };
        self.indexes[topic as usize].records.push(entry);
        let at = self.bytes.len();
        let previous = self.last[topic as usize].replace(at);
        let previous = previous.filter(|previous| at - previous <= MAX_DISTANCE);
        self.starts.push(MessageStart { at, previous });
        let (first, last) = self.bounds.unwrap_or((time, time));
        self.bounds = Some((first.min(time), last.max(time)));
        let channel_id = topic.id();
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        self.bytes.extend_from_slice(&message_header(&header, data_bytes));
    }

    /// Compresses the messages into the records of a chunk at `offset` in the file, and starts a
    /// new chunk.
    pub(crate) fn finish(
        &mut self,
        offset: u64,
        compressor: &Compressor,
    ) -> Result<FinishedChunk<'_>, McapError> {
        let Self { bytes, starts, last, indexes, bounds, written } = self;
        let (message_start_time, message_end_time) = bounds.take().unwrap_or_default();
        let mut header = ChunkHeader {
            message_start_time,
            message_end_time,
            uncompressed_size: bytes.len() as u64,
            uncompressed_crc: crc32fast::hash(bytes),
            compression: compression::METHOD.to_owned(),
            compressed_size: 0,
        };
        written.clear();
        written.shrink_to(KEPT_BYTES);
        put_record(written, op::CHUNK, &header)?;
        let messages_at = written.len();
        compressor.compress(bytes, starts, written);
        bytes.clear();
        starts.clear();
        *last = Default::default();
        bytes.shrink_to(KEPT_BYTES);
        let chunk_length = written.len() as u64;

        // The compressed length is known only now.
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
