//! Reading a recording entry by entry.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{ErrorKind, Read};
use std::sync::Arc;
use std::time::Duration;

use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError};
use memchr::memmem;
use serde::Deserialize;

use crate::compression::decompress;
use crate::error::ReadError;
use crate::record::RECORD_HEADER_BYTES;
use crate::ros::{
    JointArray, JointNames, JointState, JointTrajectory, MotionMessage, PoseStamped, Text, Time,
};
use crate::{
    Attachment, Entry, JointSample, MotionEntry, MotionSample, PoseSample, Topic, TrajectoryPoint,
    cdr,
};

/// Maximum length of a record or chunk: 512 MiB, a trajectory of 2.6 million points. The bound
/// prevents a damaged length from requesting more memory than exists.
const RECORD_LIMIT_BYTES: usize = 512 * 1024 * 1024;

/// Smallest and largest request to the stream, bytes.
const READ_BYTES: std::ops::RangeInclusive<usize> = 64 * 1024..=1024 * 1024;

/// Reads a recording from a stream in one pass, with one chunk in memory at a time.
///
/// The reader is an iterator over the entries in file order; it ends after the first error. Topics
/// other than those of [`Topic`] are skipped, and so is `/tf`, which follows from the joint
/// positions. All checksums of the file are verified. Bytes after the end of the file are an error,
/// unless they end like a complete file: a killed [`Recorder`](crate::Recorder) may leave such
/// bytes.
pub struct Reader<R> {
    stream: R,
    mcap: LinearReader,
    chunk: UnpackedChunk,
    content: ReaderState,
    offset: u64,
    /// Last bytes read, up to twice the length of the magic bytes.
    end: Vec<u8>,
    /// `true` if another file follows the end of a file: both were concatenated.
    is_concatenated: bool,
    done: bool,
}

impl<R> std::fmt::Debug for Reader<R> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Reader")
            .field("content", &self.content)
            .field("offset", &self.offset)
            .field("done", &self.done)
            .finish_non_exhaustive()
    }
}

impl<R: Read> Reader<R> {
    /// Starts reading at the current position of `stream`, which needs no buffering.
    pub fn new(stream: R) -> Self {
        let options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true)
            .with_check_finishes_after_end_magic(true)
            .with_record_length_limit(RECORD_LIMIT_BYTES);
        Self {
            stream,
            mcap: LinearReader::new_with_options(options),
            chunk: UnpackedChunk::default(),
            content: ReaderState::default(),
            offset: 0,
            end: Vec::new(),
            is_concatenated: false,
            done: false,
        }
    }

    /// Skips messages of all other topics, whatever they contain, which is faster than decoding
    /// them. Attachments and metadata are read.
    #[must_use]
    pub fn only(mut self, topics: &[Topic]) -> Self {
        self.content.wanted = Some(topics.to_vec());
        self
    }

    /// Instant of `t_s` = 0 as the time since 1970-01-01T00:00:00Z: the log time of the first
    /// message. `None` before the first message.
    #[must_use]
    pub fn epoch(&self) -> Option<Duration> {
        self.content.epoch_ns.map(Duration::from_nanos)
    }

    /// Reads up to the next entry.
    fn advance(&mut self) -> Result<Option<Entry>, ReadError> {
        loop {
            let offset = self.offset;
            while let Some((opcode, data)) =
                self.chunk.next().map_err(|source| self.content.broken(offset, source))?
            {
                if let Some(entry) = self.content.take(opcode, data, offset)? {
                    return Ok(Some(entry));
                }
            }
            let need = match self.mcap.next_event() {
                None => return Ok(None),
                Some(Err(source @ McapError::BytesAfterEndMagic)) => {
                    if self.is_concatenated {
                        return Err(ReadError::Concatenated);
                    }
                    if self.rest_ends_a_file()? {
                        return Ok(None);
                    }
                    return Err(self.content.broken(self.offset, source));
                }
                Some(Err(source)) => return Err(self.content.broken(offset, source)),
                Some(Ok(LinearReadEvent::ReadRequest(need))) => need,
                Some(Ok(LinearReadEvent::Record { data, opcode: op::CHUNK })) => {
                    self.chunk.load(data).map_err(|source| self.content.broken(offset, source))?;
                    continue;
                }
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    match self.content.take(opcode, data, offset)? {
                        None => continue,
                        entry => return Ok(entry),
                    }
                }
            };
            let room = self.mcap.insert(need.clamp(*READ_BYTES.start(), *READ_BYTES.end()));
            let read = read(&mut self.stream, room)
                .map_err(|source| ReadError::Io { offset: self.offset, source })?;
            self.is_concatenated |= keep_end(&mut self.end, &room[..read]);
            self.mcap.notify_read(read);
            self.offset += read as u64;
        }
    }

    /// Reads to the end of the stream, and returns true if it ends like a complete file.
    fn rest_ends_a_file(&mut self) -> Result<bool, ReadError> {
        let mut room = vec![0; *READ_BYTES.start()];
        loop {
            match read(&mut self.stream, &mut room) {
                Err(source) => return Err(ReadError::Io { offset: self.offset, source }),
                Ok(0) if self.is_concatenated => return Err(ReadError::Concatenated),
                Ok(0) => return Ok(self.end.ends_with(MAGIC)),
                Ok(read) => {
                    self.is_concatenated |= keep_end(&mut self.end, &room[..read]);
                    self.offset += read as u64;
                }
            }
        }
    }
}

impl<R: Read> Iterator for Reader<R> {
    type Item = Result<Entry, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.done {
            return None;
        }
        let entry = self.advance().transpose();
        self.done = !matches!(entry, Some(Ok(_)));
        entry
    }
}

/// Reads once, and repeats the call after interrupts.
pub(crate) fn read<R: Read>(stream: &mut R, room: &mut [u8]) -> std::io::Result<usize> {
    loop {
        match stream.read(room) {
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            result => return result,
        }
    }
}

/// Updates the kept end of the stream. Returns true if the magic bytes of a file's end and of
/// another file's beginning follow each other.
fn keep_end(end: &mut Vec<u8>, read: &[u8]) -> bool {
    let border = [MAGIC, MAGIC].concat();
    let kept = end.len();
    end.extend(&read[..read.len().min(border.len())]);
    let is_border = [&end[..], read].iter().any(|bytes| memmem::find(bytes, &border).is_some());
    end.truncate(kept);
    end.extend(&read[read.len().saturating_sub(border.len())..]);
    end.drain(..end.len().saturating_sub(border.len()));
    is_border
}

/// Records of the current chunk, unpacked.
#[derive(Debug, Default)]
struct UnpackedChunk {
    records: Vec<u8>,
    /// Start of the next record.
    next: usize,
}

impl UnpackedChunk {
    /// Unpacks the content of a chunk record.
    fn load(&mut self, data: &[u8]) -> Result<(), McapError> {
        lengths_fit(op::CHUNK, data).ok_or(McapError::UnexpectedEoc)?;
        self.next = 0;
        if let Record::Chunk { header, data } = mcap::parse_record(op::CHUNK, data)? {
            decompress(&header, &data, RECORD_LIMIT_BYTES, &mut self.records)?;
        }
        Ok(())
    }

    /// Opcode and content of the next record.
    fn next(&mut self) -> Result<Option<(u8, &[u8])>, McapError> {
        let rest = &self.records[self.next..];
        if rest.is_empty() {
            return Ok(None);
        }
        let record = || {
            let (opcode, rest) = rest.split_first()?;
            let (length, rest) = rest.split_first_chunk()?;
            let content = rest.get(..usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
            Some((*opcode, content))
        };
        let (opcode, content) = record().ok_or(McapError::UnexpectedEoc)?;
        self.next += RECORD_HEADER_BYTES + content.len();
        Ok(Some((opcode, content)))
    }
}

/// Parses the record types of a recording, and skips all others.
fn parse(opcode: u8, data: &[u8]) -> Result<Option<Record<'_>>, McapError> {
    if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE | op::METADATA | op::ATTACHMENT) {
        return Ok(None);
    }
    if lengths_fit(opcode, data).is_none() {
        return Err(McapError::RecordTooLarge { opcode, len: data.len() as u64 });
    }
    mcap::parse_record(opcode, data).map(Some)
}

/// Returns `Some` if the lengths in a record fit its data. The parser relies on this, and allocates
/// as much memory as they state.
fn lengths_fit(opcode: u8, data: &[u8]) -> Option<()> {
    match opcode {
        // A number; name, encoding and content.
        op::SCHEMA => texts(data.get(2..)?, 3).map(drop),
        // Two numbers; topic, encoding and a map.
        op::CHANNEL => map(texts(data.get(4..)?, 2)?),
        op::METADATA => map(texts(data, 1)?),
        // Two times, a length and a checksum; method; compressed data with a longer length.
        op::CHUNK => {
            let (len, content) = texts(data.get(28..)?, 1)?.split_first_chunk()?;
            content.get(..usize::try_from(u64::from_le_bytes(*len)).ok()?).map(drop)
        }
        // Two times; name and type; content with a longer length, and its checksum.
        op::ATTACHMENT => {
            let (len, content) = texts(data.get(16..)?, 2)?.split_first_chunk()?;
            let len = usize::try_from(u64::from_le_bytes(*len)).ok()?;
            content.get(len.checked_add(4)?..).map(drop)
        }
        _ => Some(()),
    }
}

/// Returns the data after `count` texts, each preceded by its length.
fn texts(mut rest: &[u8], count: usize) -> Option<&[u8]> {
    for _ in 0..count {
        let (len, tail) = rest.split_first_chunk()?;
        rest = tail.get(usize::try_from(u32::from_le_bytes(*len)).ok()?..)?;
    }
    Some(rest)
}

/// Returns `Some` if a map, preceded by its length in bytes, is complete.
fn map(data: &[u8]) -> Option<()> {
    let (len, tail) = data.split_first_chunk()?;
    let mut entries = tail.get(..usize::try_from(u32::from_le_bytes(*len)).ok()?)?;
    while !entries.is_empty() {
        entries = texts(entries, 2)?;
    }
    Some(())
}

/// Returns the topic of joint states in a namespace, such as `/lbr/joint_states`.
fn in_namespace(name: &str) -> Option<Topic> {
    name.ends_with(Topic::JointStates.name()).then_some(Topic::JointStates)
}

/// State of the reader apart from the container.
#[derive(Debug, Default)]
struct ReaderState {
    schemas: BTreeMap<u16, (String, String)>,
    channels: BTreeMap<u16, Option<Topic>>,
    /// Topics to read; all if `None`.
    wanted: Option<Vec<Topic>>,
    /// `true` if the file has `/joint_states`: topics in namespaces are then of other devices.
    has_joint_states: bool,
    /// Names of the topics of joint states in a namespace, by their channels.
    namespaces: BTreeMap<u16, String>,
    /// Name of the topic in a namespace that joint states are read from.
    namespace: Option<String>,
    epoch_ns: Option<u64>,
    frame_id: Arc<str>,
    messages: u64,
}

impl ReaderState {
    fn broken(&self, offset: u64, source: McapError) -> ReadError {
        let messages = self.messages;
        match source {
            McapError::UnexpectedEof => ReadError::Truncated { offset, messages },
            source => ReadError::Mcap { offset, messages, source },
        }
    }

    /// Takes a record that ends before `offset` in the file.
    fn take(&mut self, opcode: u8, data: &[u8], offset: u64) -> Result<Option<Entry>, ReadError> {
        let record = parse(opcode, data).map_err(|source| self.broken(offset, source))?;
        match record {
            Some(Record::Schema { header, .. }) => {
                self.schemas.insert(header.id, (header.name, header.encoding));
                Ok(None)
            }
            Some(Record::Channel(channel)) => {
                let is_wanted = |topic: &Topic| {
                    self.wanted.as_ref().is_none_or(|wanted| wanted.contains(topic))
                };
                let mut topic = Topic::from_name(&channel.topic).filter(is_wanted);
                self.namespaces.remove(&channel.id);
                if let Some(topic) = topic {
                    self.check_type(topic, &channel)?;
                    self.has_joint_states |= topic == Topic::JointStates;
                } else if in_namespace(&channel.topic).as_ref().is_some_and(is_wanted)
                    && self.check_type(Topic::JointStates, &channel).is_ok()
                {
                    topic = Some(Topic::JointStates);
                    self.namespaces.insert(channel.id, channel.topic);
                }
                self.channels.insert(channel.id, topic);
                Ok(None)
            }
            Some(Record::Message { header, data }) => {
                let epoch_ns = *self.epoch_ns.get_or_insert(header.log_time);
                let topic = *self.channels.get(&header.channel_id).ok_or_else(|| {
                    let source = McapError::UnknownChannel(header.sequence, header.channel_id);
                    self.broken(offset, source)
                })?;
                self.messages += 1;
                let Some(topic) = topic else { return Ok(None) };
                let body =
                    EncodedMessage { topic, epoch_ns, log_ns: header.log_time, bytes: &data };
                let name = self.namespaces.get(&header.channel_id).cloned();
                if topic == Topic::JointStates {
                    self.joint_state(name, &body)
                } else {
                    self.message(&body)
                }
            }
            Some(Record::Attachment { header, data, .. }) => {
                Ok(Some(Entry::Attachment(Attachment {
                    name: header.name,
                    media_type: header.media_type,
                    bytes: data.into_owned(),
                })))
            }
            Some(Record::Metadata(metadata)) => {
                Ok(Some(Entry::Metadata { name: metadata.name, entries: metadata.metadata }))
            }
            _ => Ok(None),
        }
    }

    /// Reads a joint state on the topic `name` in a namespace, or on `/joint_states`. Messages of
    /// other devices, such as a gripper, are left out.
    fn joint_state(
        &mut self,
        name: Option<String>,
        body: &EncodedMessage<'_>,
    ) -> Result<Option<Entry>, ReadError> {
        let first = self.namespace.clone();
        let Some(name) = name else {
            let second = Topic::JointStates.name().to_owned();
            return match first {
                Some(first) => Err(ReadError::TwoArms { first, second }),
                None => self.message(body),
            };
        };
        if self.has_joint_states {
            return Ok(None);
        }
        let entry = match self.message(body) {
            Err(ReadError::JointName { .. } | ReadError::JointCount { .. })
                if first.as_ref() != Some(&name) =>
            {
                return Ok(None);
            }
            entry => entry?,
        };
        match first {
            Some(first) if first != name => Err(ReadError::TwoArms { first, second: name }),
            _ => {
                self.namespace = Some(name);
                Ok(entry)
            }
        }
    }

    fn check_type(&self, topic: Topic, channel: &mcap::records::Channel) -> Result<(), ReadError> {
        let expected = (topic.type_name(), Topic::SCHEMA_ENCODING, Topic::MESSAGE_ENCODING);
        let (name, schema_encoding) = self
            .schemas
            .get(&channel.schema_id)
            .map_or(("nothing", "no schema"), |(name, encoding)| (name, encoding));
        let found = (name, schema_encoding, channel.message_encoding.as_str());
        if found == expected {
            return Ok(());
        }
        let show =
            |(name, schema, message): (&str, &str, &str)| format!("{name} ({message}, {schema})");
        Err(ReadError::WrongType { topic, expected: show(expected), found: show(found) })
    }

    fn message(&mut self, body: &EncodedMessage<'_>) -> Result<Option<Entry>, ReadError> {
        Ok(Some(match body.topic {
            Topic::Tf | Topic::Diagnostics => return Ok(None),
            Topic::JointStates => Entry::JointState(body.joint_state()?),
            topic @ (Topic::TcpPose | Topic::FlangePose) => {
                let message: PoseStamped<'_> = body.decode()?;
                if *self.frame_id != *message.header.frame_id {
                    self.frame_id = Arc::from(message.header.frame_id.as_ref());
                }
                let sample = PoseSample {
                    t_s: body.stamp_s(message.header.stamp)?,
                    frame_id: Arc::clone(&self.frame_id),
                    position_m: message.position,
                    rotation_xyzw: message.orientation,
                };
                if topic == Topic::TcpPose {
                    Entry::TcpPose(sample)
                } else {
                    Entry::FlangePose(sample)
                }
            }
            Topic::Motion => Entry::Motion(body.motion()?),
            Topic::JointTrajectory => body.trajectory()?,
            Topic::RobotDescription => {
                let text: Text<'_> = body.decode()?;
                Entry::RobotDescription { t_s: body.t_s(), urdf: text.data.into_owned() }
            }
        }))
    }
}

/// A message of a known topic, still encoded.
struct EncodedMessage<'a> {
    topic: Topic,
    epoch_ns: u64,
    log_ns: u64,
    bytes: &'a [u8],
}

impl<'a> EncodedMessage<'a> {
    fn decode<T: Deserialize<'a>>(&self) -> Result<T, ReadError> {
        cdr::decode(self.bytes).map_err(|what| self.error(what))
    }

    fn joint_state(&self) -> Result<JointSample, ReadError> {
        let message: JointState<'_> = self.decode()?;
        self.check_names("name", message.name)?;
        Ok(JointSample {
            t_s: self.stamp_s(message.header.stamp)?,
            log_s: self.t_s(),
            is_stamped: message.header.stamp != Time::default(),
            q: self.seven("position", &message.position)?,
            dq: match message.velocity.len {
                0 => None,
                _ => Some(self.seven("velocity", &message.velocity)?),
            },
            torques_nm: match message.effort.len {
                0 => None,
                _ => Some(self.seven("effort", &message.effort)?),
            },
        })
    }

    fn motion(&self) -> Result<MotionSample, ReadError> {
        let message = MotionMessage::decode(self.bytes).map_err(|what| self.error(what))?;
        let stated = |text: Cow<'_, str>| (!text.is_empty()).then(|| text.into_owned().into());
        let limiting_joint = match message.limiting_joint {
            0 => None,
            1..=7 => u8::try_from(message.limiting_joint).ok(),
            other => return Err(self.error(format!("limiting joint {other}, expected 0 to 7"))),
        };
        Ok(MotionSample {
            t_s: self.stamp_s(message.header.stamp)?,
            motion: MotionEntry {
                index: message.index,
                kind: Cow::Owned(message.kind.into_owned()),
                limiting_joint,
                limiting_kind: Cow::Owned(message.limiting_kind.into_owned()),
                name: stated(message.name),
                group: stated(message.group),
            },
        })
    }

    fn trajectory(&self) -> Result<Entry, ReadError> {
        let message: JointTrajectory<'_> = self.decode()?;
        self.check_names("joint_names", message.joint_names)?;
        let point = |(i, point): (usize, &crate::ros::JointTrajectoryPoint)| {
            Ok(TrajectoryPoint {
                time_from_start: point.time_from_start.to_duration().ok_or_else(|| {
                    self.error(format!("point {i}: time {:?}", point.time_from_start))
                })?,
                positions: self.seven("positions", &point.positions)?,
                velocities: self.seven("velocities", &point.velocities)?,
                accelerations: self.seven("accelerations", &point.accelerations)?,
            })
        };
        Ok(Entry::Trajectory {
            t_s: self.stamp_s(message.header.stamp)?,
            points: message.points.iter().enumerate().map(point).collect::<Result<_, _>>()?,
        })
    }

    fn check_names(&self, field: &'static str, names: JointNames<'_>) -> Result<(), ReadError> {
        let (topic, t_s) = (self.topic, self.t_s());
        match names {
            JointNames::Of(_) => Ok(()),
            JointNames::Other { index, expected, found } => {
                Err(ReadError::JointName { topic, t_s, index: index + 1, expected, found })
            }
            JointNames::Count(found) => Err(ReadError::JointCount { topic, t_s, field, found }),
        }
    }

    fn seven(&self, field: &'static str, joints: &JointArray) -> Result<[f64; 7], ReadError> {
        joints.seven().ok_or(ReadError::JointCount {
            topic: self.topic,
            t_s: self.t_s(),
            field,
            found: joints.len,
        })
    }

    /// Stamp of a header, s since the epoch.
    fn stamp_s(&self, stamp: Time) -> Result<f64, ReadError> {
        let since_1970 =
            stamp.to_duration().ok_or_else(|| self.error(format!("stamp {stamp:?}")))?;
        Ok(self.since_epoch(since_1970))
    }

    /// Log time, s since the epoch.
    fn t_s(&self) -> f64 {
        self.since_epoch(Duration::from_nanos(self.log_ns))
    }

    fn since_epoch(&self, since_1970: Duration) -> f64 {
        let epoch = Duration::from_nanos(self.epoch_ns);
        let gap_s = since_1970.abs_diff(epoch).as_secs_f64();
        if since_1970 < epoch { -gap_s } else { gap_s }
    }

    fn error(&self, what: String) -> ReadError {
        ReadError::Message { topic: self.topic, t_s: self.t_s(), message: what }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_beyond_its_record_is_refused() {
        // A schema whose name claims 4 GB.
        let mut schema = vec![1, 0];
        schema.extend(u32::MAX.to_le_bytes());
        schema.extend([0; 16]);
        assert!(parse(op::SCHEMA, &schema).is_err());
        // A channel whose map ends within an entry.
        let mut channel = vec![1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0];
        channel.extend(9_u32.to_le_bytes());
        assert!(parse(op::CHANNEL, &channel).is_err());
        assert!(parse(op::METADATA, &[255; 3]).is_err());
    }
}
