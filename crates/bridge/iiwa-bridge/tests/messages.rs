//! Messages in all formats. `tests/peers` validates them against their JSON Schema.

use iiwa_bridge::{Kind, Message, encoding::JointFormat};

use crate::sample_messages::all;

#[test]
fn messages_come_back_as_they_were() {
    for message in all() {
        let text = message.to_json();
        assert_eq!(Message::from_json(text.as_bytes()).unwrap(), message, "{text}");
    }
    for kind in Kind::ALL {
        assert!(all().iter().any(|message| message.kind() == kind), "{}", kind.name());
        assert_eq!(Kind::ALL[kind.index()], kind);
    }
}

#[test]
fn another_version_is_not_read() {
    let text = all()[0].to_json().replace("\"version\":1", "\"version\":2");
    let error = Message::from_json(text.as_bytes()).unwrap_err().to_string();
    assert!(error.starts_with("the message has version 2 of the schema"), "{error}");
}

#[test]
fn joints_in_protobuf_come_back_as_they_were() {
    for message in all() {
        let bytes = JointFormat::Protobuf.encode(&message);
        if message.kind() == Kind::Joints {
            assert!(!JointFormat::is_json(&bytes));
            assert_eq!(JointFormat::decode_protobuf(&bytes).unwrap(), message);
        } else {
            assert_eq!(Message::from_json(&bytes).unwrap(), message);
        }
    }
    assert!(JointFormat::decode_protobuf(b"\xff\xff nonsense").is_none());
}

#[test]
fn joints_in_cdr_are_a_joint_state() {
    let bytes = JointFormat::Cdr.encode(&all()[1]);
    // Little-endian CDR header, seconds, nanoseconds, frame with length and terminating zero.
    assert_eq!(bytes[..4], [0, 1, 0, 0]);
    assert_eq!(bytes[4..8], 1_764_108_000_i32.to_le_bytes());
    assert_eq!(bytes[8..12], 123_456_000_u32.to_le_bytes());
    assert_eq!(bytes[12..16], 7_u32.to_le_bytes());
    assert_eq!(&bytes[16..23], b"cell-1\0");
    // Seven torques of 1 Nm at the end.
    assert!(bytes.ends_with(&[1.0_f64.to_le_bytes(); 7].concat()));
}
