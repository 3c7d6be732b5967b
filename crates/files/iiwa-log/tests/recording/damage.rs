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
    let schema = Arc::new(Schema {
        id: 1,
        name: type_name.into(),
        encoding: "ros2msg".into(),
        data: Cow::Owned(topic.schema().into_bytes()),
    });
    let mut writer = WriteOptions::new().create(Cursor::new(Vec::new())).unwrap();
    let time = u64::try_from(DEFAULT_EPOCH.as_nanos()).unwrap();
    for (id, name) in (1..).zip(names) {
        let channel = Channel {
            id,
            topic: (*name).to_owned(),
            schema: Some(Arc::clone(&schema)),
            message_encoding: encoding.into(),
            metadata: BTreeMap::new(),
        };
        writer
            .write(&Message {
                channel: Arc::new(channel),
                sequence: 0,
                log_time: time,
                publish_time: time,
                data: Cow::Borrowed(data),
            })
            .unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
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
    let mut body = Body::header(1_577_836_800, 0).word(u32::try_from(names.len()).unwrap());
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

    let mut unset = data.clone();
    unset[4..12].fill(0);
    assert_eq!(read_joint_state(&unset).unwrap().joint_states[0].t_s, 0.0);
}

#[test]
fn a_second_file_behind_the_first_is_reported() {
    let file = foreign(
        Topic::JointStates,
        Topic::JointStates.type_name(),
        "cdr",
        &joint_state(&JOINT_NAMES, &[0.5; 7], &[]),
    );
    let error = Recording::from_bytes(&[&*file, &file].concat()).unwrap_err();
    assert!(matches!(error, ReadError::Concatenated), "{error}");
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
