//! MCAP file under construction.
//!
//! The writer of the `mcap` crate passes every field of every message to the compressor separately,
//! which takes longer than the compression itself. The record contents are encoded by the `mcap`
//! crate.

use std::collections::BTreeMap;
use std::io::Write;

use mcap::records::{AttachmentHeader, AttachmentIndex, Header, Metadata, MetadataIndex, op};
use mcap::{MAGIC, McapError};

use crate::chunk::Chunk;
use crate::compression::Compressor;
use crate::record::{PADDING, append, put, put_record};
use crate::tail::Index;

/// Writes records into a stream, in one pass.
pub(crate) struct Container<W> {
    sink: ChecksumStream<W>,
    chunk: Chunk,
    chunk_bytes: usize,
    compressor: Compressor,
    index: Index,
}

impl<W: Write> Container<W> {
    /// Begins a file in an empty stream.
    pub(crate) fn new(stream: W, library: String, chunk_bytes: usize) -> Result<Self, McapError> {
        let mut sink =
            ChecksumStream { stream, offset: 0, crc: crc32fast::Hasher::new(), failed: false };
        let mut start = MAGIC.to_vec();
        put_record(&mut start, op::HEADER, &Header { profile: "ros2".to_owned(), library })?;
        sink.write(&start)?;
        Ok(Self {
            sink,
            chunk: Chunk::with_capacity(chunk_bytes),
            chunk_bytes,
            compressor: Compressor::new()?,
            index: Index::default(),
        })
    }

    /// Returns the chunk for a message with `data_bytes` bytes of data: the current chunk or a new
    /// one. A reader unpacks a chunk as a whole, so a very large message gets a chunk of its own.
    pub(crate) fn chunk_for(&mut self, data_bytes: usize) -> Result<&mut Chunk, McapError> {
        if self.chunk.len_with(data_bytes) > self.chunk_bytes {
            self.end_chunk()?;
        }
        Ok(&mut self.chunk)
    }

    /// Ends the current chunk; all messages so far are then in the stream.
    pub(crate) fn end_chunk(&mut self) -> Result<(), McapError> {
        if self.chunk.is_empty() {
            return Ok(());
        }
        let finished = self.chunk.finish(self.sink.offset, &self.compressor)?;
        self.index.chunk(&finished.index, &finished.counts)?;
        self.sink.write(finished.records)
    }

    /// Attaches a file. Ends the current chunk.
    pub(crate) fn attach(
        &mut self,
        header: AttachmentHeader,
        bytes: &[u8],
    ) -> Result<(), McapError> {
        self.end_chunk()?;
        let mut content = Vec::new();
        append(&mut content, &header)?;
        append(&mut content, &(bytes.len() as u64))?;
        content.extend(bytes);
        let crc = crc32fast::hash(&content);
        append(&mut content, &crc)?;
        let (offset, length) = self.put(op::ATTACHMENT, &content)?;
        self.index.attachment(&AttachmentIndex {
            offset,
            length,
            log_time: header.log_time,
            create_time: header.create_time,
            data_size: bytes.len() as u64,
            name: header.name,
            media_type: header.media_type,
        })
    }

    /// Writes a metadata record. Ends the current chunk.
    pub(crate) fn metadata(
        &mut self,
        name: &str,
        entries: &BTreeMap<String, String>,
    ) -> Result<(), McapError> {
        self.end_chunk()?;
        let name = name.to_owned();
        let mut content = Vec::new();
        append(&mut content, &Metadata { name: name.clone(), metadata: entries.clone() })?;
        let (offset, length) = self.put(op::METADATA, &content)?;
        self.index.metadata(&MetadataIndex { offset, length, name })
    }

    /// Ends the current chunk and pads the file with a record that readers skip.
    pub(crate) fn pad(&mut self, bytes: &[u8]) -> Result<(), McapError> {
        self.end_chunk()?;
        self.put(PADDING, bytes).map(drop)
    }

    /// Writes the tail and returns the stream.
    pub(crate) fn finish(mut self) -> Result<W, McapError> {
        self.end_chunk()?;
        let tail = self.index.tail(self.sink.offset, self.sink.crc.clone().finalize())?;
        self.sink.write(&tail)?;
        self.sink.stream.flush()?;
        Ok(self.sink.stream)
    }

    /// Bytes of the file written so far.
    pub(crate) fn offset(&self) -> u64 {
        self.sink.offset
    }

    /// Content of the summary up to now.
    pub(crate) fn index(&self) -> &Index {
        &self.index
    }

    pub(crate) fn stream_mut(&mut self) -> &mut W {
        &mut self.sink.stream
    }

    /// Writes a record and returns its offset and length.
    fn put(&mut self, opcode: u8, content: &[u8]) -> Result<(u64, u64), McapError> {
        let mut record = Vec::new();
        put(&mut record, opcode, content);
        let offset = self.sink.offset;
        self.sink.write(&record)?;
        Ok((offset, record.len() as u64))
    }
}

/// Stream with the length and the checksum of the written bytes.
struct ChecksumStream<W> {
    stream: W,
    offset: u64,
    crc: crc32fast::Hasher,
    failed: bool,
}

impl<W: Write> ChecksumStream<W> {
    /// Writes all bytes. After an error, the file length is unknown and every further write fails.
    fn write(&mut self, bytes: &[u8]) -> Result<(), McapError> {
        if std::mem::replace(&mut self.failed, true) {
            return Err(McapError::AttemptedWriteAfterFailure);
        }
        self.stream.write_all(bytes)?;
        self.crc.update(bytes);
        self.offset += bytes.len() as u64;
        self.failed = false;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::time::Duration;

    use mcap::records::Record;
    use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

    use super::*;
    use crate::Topic;

    const MESSAGES: u32 = 20_000;
    const SHORT_CHUNK: usize = 128 * 1024;

    /// Topic, sequence number, time and data.
    fn message(k: u32) -> (Topic, u32, u64, Vec<u8>) {
        let topic = if k.is_multiple_of(7) { Topic::TcpPose } else { Topic::JointStates };
        let time = Duration::from_millis(u64::from(k)).as_nanos();
        let data = f64::from(k).sqrt().to_le_bytes().repeat(1 + k as usize % 60);
        (topic, k, u64::try_from(time).unwrap(), data)
    }

    fn entries() -> BTreeMap<String, String> {
        [("key", "value"), ("other", "")].map(|(k, v)| (k.to_owned(), v.to_owned())).into()
    }

    fn attachment(name: &str) -> AttachmentHeader {
        let (name, media_type) = (name.to_owned(), "text/plain".to_owned());
        AttachmentHeader { log_time: 1, create_time: 2, name, media_type }
    }

    fn file(chunk_bytes: usize) -> Vec<u8> {
        let mut container = Container::new(Vec::new(), "test".to_owned(), chunk_bytes).unwrap();
        let mut open = Vec::new();
        for (topic, sequence, time, data) in (0..MESSAGES).map(message) {
            let chunk = container.chunk_for(data.len()).unwrap();
            if !open.contains(&topic) {
                open.push(topic);
                chunk.define(topic).unwrap();
            }
            chunk.message(topic, sequence, time, &data);
            if sequence % 5000 == 4999 {
                container.end_chunk().unwrap();
            }
        }
        container.attach(attachment("a.txt"), b"content").unwrap();
        container.attach(attachment("b.txt"), b"").unwrap();
        container.metadata("figures", &entries()).unwrap();
        container.finish().unwrap()
    }

    /// Encodes the test messages with the writer of the `mcap` crate.
    fn peer() -> Vec<u8> {
        let mut writer = mcap::WriteOptions::new()
            .profile("ros2")
            .library("test")
            .create(Cursor::new(Vec::new()))
            .unwrap();
        let mut open = Vec::new();
        for (topic, sequence, time, data) in (0..MESSAGES).map(message) {
            let id = topic.id();
            if !open.contains(&topic) {
                open.push(topic);
                let schema = topic.schema();
                let qos = topic.offered_qos_profiles().to_owned();
                let metadata = [("offered_qos_profiles".to_owned(), qos)].into();
                writer
                    .add_schema_with_id(id, topic.type_name(), "ros2msg", schema.as_bytes())
                    .unwrap();
                writer.add_channel_with_id(id, id, topic.name(), "cdr", &metadata).unwrap();
            }
            let header = mcap::records::MessageHeader {
                channel_id: id,
                sequence,
                log_time: time,
                publish_time: time,
            };
            writer.write_to_known_channel(&header, &data).unwrap();
        }
        for (name, data) in [("a.txt", &b"content"[..]), ("b.txt", b"")] {
            let AttachmentHeader { log_time, create_time, name, media_type } = attachment(name);
            let data = data.into();
            let attachment = mcap::Attachment { log_time, create_time, name, media_type, data };
            writer.attach(&attachment).unwrap();
        }
        let metadata = Metadata { name: "figures".to_owned(), metadata: entries() };
        writer.write_metadata(&metadata).unwrap();
        writer.finish().unwrap();
        writer.into_inner().into_inner()
    }

    /// All records of a file, with chunks unpacked and checksums verified.
    fn records(file: &[u8]) -> Vec<Record<'static>> {
        let options = LinearReaderOptions::default()
            .with_validate_chunk_crcs(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true);
        let mut reader = LinearReader::new_with_options(options);
        let (mut rest, mut records) = (file, Vec::new());
        while let Some(event) = reader.next_event() {
            match event.unwrap() {
                LinearReadEvent::ReadRequest(length) => {
                    let (now, later) = rest.split_at(length.min(rest.len()));
                    reader.insert(now.len()).copy_from_slice(now);
                    reader.notify_read(now.len());
                    rest = later;
                }
                LinearReadEvent::Record { data, opcode } => {
                    records.push(mcap::parse_record(opcode, data).unwrap().into_owned());
                }
            }
        }
        assert_eq!(rest, b"");
        records
    }

    /// Cross-validation against the writer of the `mcap` crate.
    #[test]
    fn a_file_is_the_one_of_mcap() {
        let theirs = peer();
        let same = |record: &Record<'_>| {
            !matches!(
                record,
                Record::MessageIndex(_)
                    | Record::ChunkIndex(_)
                    | Record::AttachmentIndex(_)
                    | Record::MetadataIndex(_)
                    | Record::SummaryOffset(_)
                    | Record::Statistics(_)
                    | Record::DataEnd(_)
                    | Record::Footer(_)
            )
        };
        let content = |file: &[u8]| -> Vec<String> {
            records(file).iter().filter(|r| same(r)).map(|r| format!("{r:?}")).collect()
        };
        for chunk_bytes in [SHORT_CHUNK, 1024 * 1024] {
            let ours = file(chunk_bytes);
            assert!(content(&ours) == content(&theirs));

            let [ours, theirs] = [&ours, &theirs].map(|f| mcap::Summary::read(f).unwrap().unwrap());
            assert_eq!((&ours.channels, &ours.schemas), (&theirs.channels, &theirs.schemas));
            let statistics = |summary: &mcap::Summary| {
                let mut statistics = summary.stats.clone().unwrap();
                statistics.chunk_count = 0;
                statistics
            };
            assert_eq!(statistics(&ours), statistics(&theirs));
        }
    }

    #[test]
    fn indexes_say_where_everything_is() {
        let file = file(SHORT_CHUNK);
        let summary = mcap::Summary::read(&file).unwrap().unwrap();
        assert!(summary.chunk_indexes.len() > 8);
        let mut messages = Vec::new();
        for chunk in &summary.chunk_indexes {
            for (channel, entries) in summary.read_message_indexes(&file, chunk).unwrap() {
                for entry in entries {
                    let message = summary.seek_message(&file, chunk, &entry).unwrap();
                    assert_eq!((&message.channel, message.log_time), (&channel, entry.log_time));
                    messages.push((message.sequence, message.log_time, message.data.into_owned()));
                }
            }
        }
        messages.sort();
        let expected = (0..MESSAGES).map(message).map(|(_, k, time, data)| (k, time, data));
        assert!(messages.into_iter().eq(expected));

        let attachments = summary.attachment_indexes.iter();
        let found: Vec<_> =
            attachments.map(|at| mcap::read::attachment(&file, at).unwrap()).collect();
        assert_eq!(found.iter().map(|a| &*a.data).collect::<Vec<_>>(), [&b"content"[..], b""]);
        let [metadata] = summary.metadata_indexes.as_slice() else { panic!("one record") };
        assert_eq!(mcap::read::metadata(&file, metadata).unwrap().metadata, entries());
    }
}
