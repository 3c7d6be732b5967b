//! Errors for files that are cut off, damaged or from another robot.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::Arc;

use crate::recording::sample::sample;
use iiwa_log::{DEFAULT_EPOCH, ReadError, Recording, Topic};

/// Joint names of most files.
const JOINT_NAMES: [&str; 7] = [
    "iiwa_joint_1",
    "iiwa_joint_2",
    "iiwa_joint_3",
    "iiwa_joint_4",
    "iiwa_joint_5",
    "iiwa_joint_6",
    "iiwa_joint_7",
];
use mcap::{Channel, Message, Schema, WriteOptions};

/// Returns a file with one message of this schema and content.
fn foreign(topic: Topic, type_name: &str, encoding: &str, data: &[u8]) -> Vec<u8> {
    on_topics(&[topic.name()], topic, type_name, encoding, data)
}

/// Returns a file with such a message on each of the topics of these names.
fn on_topics(
    names: &[&str],
    topic: Topic,
    type_name: &str,
    encoding: &str,
    data: &[u8],
) -> Vec<u8> {
    let mut writer = RosWriter { topic, type_name, encoding, messages: Vec::new() };
    for name in names {
        writer.write(name, data);
    }
    writer.finish()
}

/// Messages of one schema, logged at one message per second.
struct RosWriter<'a> {
    topic: Topic,
    type_name: &'a str,
    encoding: &'a str,
    messages: Vec<(String, Vec<u8>)>,
}

impl Default for RosWriter<'_> {
    fn default() -> Self {
        let topic = Topic::JointStates;
        Self { topic, type_name: topic.type_name(), encoding: "cdr", messages: Vec::new() }
    }
}

impl RosWriter<'_> {
    fn write(&mut self, name: &str, data: &[u8]) {
        self.messages.push((name.to_owned(), data.to_owned()));
    }

    fn finish(self) -> Vec<u8> {
        let schema = Arc::new(Schema {
            id: 1,
            name: self.type_name.into(),
            encoding: "ros2msg".into(),
            data: Cow::Owned(self.topic.schema().into_bytes()),
        });
        let mut channels: BTreeMap<String, Arc<Channel<'_>>> = BTreeMap::new();
        let mut writer = WriteOptions::new().create(Cursor::new(Vec::new())).unwrap();
        let start = u64::try_from(DEFAULT_EPOCH.as_nanos()).unwrap();
        for (second, (name, data)) in (0..).zip(self.messages) {
            let id = u16::try_from(channels.len()).unwrap() + 1;
            let channel = channels.entry(name.clone()).or_insert_with(|| {
                Arc::new(Channel {
                    id,
                    topic: name,
                    schema: Some(Arc::clone(&schema)),
                    message_encoding: self.encoding.into(),
                    metadata: BTreeMap::new(),
                })
            });
            let log_time = start + 1_000_000_000 * second;
            let message = Message {
                channel: Arc::clone(channel),
                sequence: 0,
                log_time,
                publish_time: log_time,
                data: Cow::Owned(data),
            };
            writer.write(&message).unwrap();
        }
        writer.finish().unwrap();
        writer.into_inner().into_inner()
    }
}

/// CDR body, built field by field.
#[derive(Default)]
struct Body(Vec<u8>);

impl Body {
    fn word(mut self, value: u32) -> Self {
        self.0.resize(self.0.len().next_multiple_of(4), 0);
        self.0.extend(value.to_le_bytes());
        self
    }

    fn text(self, text: &str) -> Self {
        let mut body = self.word(u32::try_from(text.len()).unwrap() + 1);
        body.0.extend(text.as_bytes());
        body.0.push(0);
        body
    }

    fn doubles(self, values: &[f64]) -> Self {
        let mut body = self.word(u32::try_from(values.len()).unwrap());
        for value in values {
            body.0.resize(body.0.len().next_multiple_of(8), 0);
            body.0.extend(value.to_le_bytes());
        }
        body
    }

    fn header(sec: u32, nanosec: u32) -> Self {
        Self::default().word(sec).word(nanosec).text("")
    }

    fn finish(self) -> Vec<u8> {
        [&[0, 1, 0, 0], &*self.0].concat()
    }
}

fn joint_state(names: &[&str], positions: &[f64], velocities: &[f64]) -> Vec<u8> {
    stamped(1_577_836_800, names, positions, velocities)
}

fn stamped(stamp_s: u32, names: &[&str], positions: &[f64], velocities: &[f64]) -> Vec<u8> {
    let mut body = Body::header(stamp_s, 0).word(u32::try_from(names.len()).unwrap());
    for name in names {
        body = body.text(name);
    }
    body.doubles(positions).doubles(velocities).doubles(&[]).finish()
}

fn read_joint_state(data: &[u8]) -> Result<Recording, ReadError> {
    let topic = Topic::JointStates;
    Recording::from_bytes(&foreign(topic, topic.type_name(), "cdr", data))
}

#[test]
fn a_foreign_writer_is_understood() {
    let recording = read_joint_state(&joint_state(&JOINT_NAMES, &[0.5; 7], &[0.25; 7])).unwrap();
    assert_eq!(recording.joint_states[0].q, [0.5; 7]);
    assert_eq!(recording.joint_states[0].dq, Some([0.25; 7]));
}

#[test]
fn other_joints_are_named() {
    let mut names = JOINT_NAMES;
    names[2] = "lbr_A3";
    let error = read_joint_state(&joint_state(&names, &[0.0; 7], &[0.0; 7])).unwrap_err();
    assert_eq!(
        error.to_string(),
        "/joint_states at 0 s: joint 3 is `lbr_A3`, expected `iiwa_joint_3`"
    );
    for (offset, name, expected) in [
        (0, "lbr_A1", "joint 2 is `iiwa_joint_2`, expected `lbr_A2`"),
        (0, "shoulder", "joint 1 is `shoulder`, expected `iiwa_joint_1`"),
        (0, "iiwa_joint_0", "joint 1 is `iiwa_joint_0`, expected `iiwa_joint_1`"),
        (6, "iiwa_joint_07", "joint 7 is `iiwa_joint_07`, expected `iiwa_joint_7`"),
    ] {
        let mut names = JOINT_NAMES;
        names[offset] = name;
        let error = read_joint_state(&joint_state(&names, &[0.0; 7], &[0.0; 7])).unwrap_err();
        assert_eq!(error.to_string(), format!("/joint_states at 0 s: {expected}"));
    }

    let error =
        read_joint_state(&joint_state(&JOINT_NAMES[..6], &[0.0; 6], &[0.0; 6])).unwrap_err();
    assert_eq!(error.to_string(), "/joint_states at 0 s: 6 entries in `name`, expected 7");
}

#[test]
fn wrong_lengths_name_the_field() {
    let cases = [(8, 7, "8 entries in `position`"), (7, 6, "6 entries in `velocity`")];
    for (positions, velocities, expected) in cases {
        let values = [0.0; 8];
        let data = joint_state(&JOINT_NAMES, &values[..positions], &values[..velocities]);
        let error = read_joint_state(&data).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// Tests what ROS drivers publish: no velocities, a namespace, no stamps.
#[test]
fn joint_states_of_ros_drivers() {
    let data = joint_state(&JOINT_NAMES, &[0.25; 7], &[]);
    let recording = read_joint_state(&data).unwrap();
    assert_eq!((recording.joint_states[0].q, recording.joint_states[0].dq), ([0.25; 7], None));

    let read = |topics: &[&str]| {
        let type_name = Topic::JointStates.type_name();
        Recording::from_bytes(&on_topics(topics, Topic::JointStates, type_name, "cdr", &data))
    };
    assert_eq!(read(&["/lbr/joint_states"]).unwrap().joint_states.len(), 1);
    let error = read(&["/a/joint_states", "/b/joint_states"]).unwrap_err().to_string();
    assert!(error.contains("/a/joint_states and /b/joint_states"), "{error}");
    // Another type in a namespace is another topic.
    let other = on_topics(&["/a/joint_states"], Topic::Tf, Topic::Tf.type_name(), "cdr", &data);
    assert_eq!(Recording::from_bytes(&other).unwrap().joint_states, []);

    // A topic of another device beside that of the arm.
    let gripper = joint_state(&["finger_1", "finger_2"], &[0.0; 2], &[]);
    let mixed = |arm: &str| {
        let [arm, gripper] = [(arm, &data), ("/gripper/joint_states", &gripper)];
        let mut writer = RosWriter::default();
        for (name, data) in [gripper, arm, gripper, arm] {
            writer.write(name, data);
        }
        Recording::from_bytes(&writer.finish()).unwrap().joint_states.len()
    };
    assert_eq!((mixed("/joint_states"), mixed("/lbr/joint_states")), (2, 2));
}

/// Tests stamps that were never set, and simulated time, which begins at zero.
#[test]
fn stamps_of_zero_are_log_times_unless_time_begins_there() {
    let read = |stamps_s: [u32; 3]| {
        let mut writer = RosWriter::default();
        for stamp_s in stamps_s {
            writer.write("/joint_states", &stamped(stamp_s, &JOINT_NAMES, &[0.5; 7], &[]));
        }
        iiwa_log::JointLog::read(&*writer.finish()).unwrap().t_s
    };
    // The writer logs one message per second.
    assert_eq!(read([0, 0, 0]), [0.0, 1.0, 2.0]);
    let simulated = read([0, 3, 6]);
    assert_eq!([simulated[1] - simulated[0], simulated[2] - simulated[1]], [3.0, 3.0]);
}

#[test]
fn a_second_file_behind_the_first_is_reported() {
    let file = foreign(
        Topic::JointStates,
        Topic::JointStates.type_name(),
        "cdr",
        &joint_state(&JOINT_NAMES, &[0.5; 7], &[]),
    );
    // The end of the first file is at, before and after the border of a read.
    for padding in 0..20 {
        let padded = [&*file, &file].concat();
        let reader = Slow { bytes: &padded, first: file.len() + padding };
        let error = Recording::read(reader).unwrap_err();
        assert!(matches!(error, ReadError::Concatenated), "{padding}: {error}");
    }
}

/// Stream whose first read has this length.
struct Slow<'a> {
    bytes: &'a [u8],
    first: usize,
}

impl std::io::Read for Slow<'_> {
    fn read(&mut self, room: &mut [u8]) -> std::io::Result<usize> {
        let (now, later) = self.bytes.split_at(self.first.min(self.bytes.len()).min(room.len()));
        room[..now.len()].copy_from_slice(now);
        self.bytes = later;
        self.first = usize::MAX;
        Ok(now.len())
    }
}

#[test]
fn messages_that_do_not_decode() {
    let good = joint_state(&JOINT_NAMES, &[0.0; 7], &[0.0; 7]);
    for len in 0..good.len() {
        let error = read_joint_state(&good[..len]).unwrap_err();
        assert!(matches!(error, ReadError::Message { .. }), "{len}: {error}");
    }
    let mut big_endian = good.clone();
    big_endian[1] = 0;
    let error = read_joint_state(&big_endian).unwrap_err().to_string();
    assert!(error.contains("representation 00 00"), "{error}");
    let longer = [&*good, &[0; 16]].concat();
    let error = read_joint_state(&longer).unwrap_err().to_string();
    assert!(error.contains("16 bytes left over"), "{error}");
    // A count that exceeds any memory.
    let data = Body::header(0, 0).word(u32::MAX).finish();
    assert!(matches!(read_joint_state(&data), Err(ReadError::Message { .. })));
    // An invalid stamp.
    let mut stamp = good;
    stamp[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = read_joint_state(&stamp).unwrap_err().to_string();
    assert!(error.contains("stamp Time"), "{error}");
}

#[test]
fn other_types_are_refused() {
    let topic = Topic::JointStates;
    let data = joint_state(&JOINT_NAMES, &[0.0; 7], &[0.0; 7]);
    let file = foreign(topic, "std_msgs/msg/String", "cdr", &data);
    let error = Recording::from_bytes(&file).unwrap_err();
    assert_eq!(
        error.to_string(),
        "/joint_states carries std_msgs/msg/String (cdr, ros2msg), \
         expected sensor_msgs/msg/JointState (cdr, ros2msg)"
    );
    let file = foreign(topic, topic.type_name(), "json", &data);
    assert!(matches!(Recording::from_bytes(&file), Err(ReadError::WrongType { .. })));
}

#[test]
fn cut_off_files_are_errors() {
    let file = sample();
    let total = mcap::MessageStream::new(&file).unwrap().count() as u64;
    for len in (0..file.len()).step_by(97).chain([file.len() - 1]) {
        let error = Recording::from_bytes(&file[..len]).unwrap_err();
        assert!(
            matches!(error, ReadError::Truncated { offset, messages }
                if offset == len as u64 && messages <= total),
            "{len}: {error}"
        );
    }
}

#[test]
fn damaged_bytes_never_panic() {
    let file = sample();
    let whole = Recording::from_bytes(&file).unwrap();
    let mut survivors = 0;
    for offset in (0..file.len()).step_by(89).chain(0..120).chain(file.len() - 240..file.len()) {
        for flip in [0x01, 0x80, 0xff] {
            let mut bytes = file.clone();
            bytes[offset] ^= flip;
            // The library in the header and the summary offsets may change without effect on the
            // content.
            if let Ok(recording) = Recording::from_bytes(&bytes) {
                assert_eq!(recording, whole, "byte {offset} went unnoticed");
                survivors += 1;
            }
        }
    }
    assert!(survivors < 40, "{survivors} flips went unnoticed");
}

#[test]
fn other_files_are_not_recordings() {
    for bytes in [&b""[..], b"{\"version\": 1}", &[0; 4096]] {
        assert!(Recording::from_bytes(bytes).is_err());
    }
    let file = [sample(), vec![0]].concat();
    assert!(matches!(Recording::from_bytes(&file), Err(ReadError::Mcap { .. })));
}

#[test]
fn a_record_longer_than_its_chunk_is_an_error() {
    let mut record = vec![0x05];
    record.extend(1_000_u64.to_le_bytes());
    record.extend([0; 20]);
    // Start and end time, uncompressed size, no checksum, no compression.
    let mut chunk = vec![0; 16];
    chunk.extend((record.len() as u64).to_le_bytes());
    chunk.extend([0; 8]);
    chunk.extend((record.len() as u64).to_le_bytes());
    chunk.extend(record);
    let mut file = mcap::MAGIC.to_vec();
    file.push(mcap::records::op::CHUNK);
    file.extend((chunk.len() as u64).to_le_bytes());
    file.extend(chunk);
    file.extend([0; 2_000]);
    assert!(matches!(
        Recording::from_bytes(&file),
        Err(ReadError::Mcap { .. } | ReadError::Truncated { .. })
    ));
}
