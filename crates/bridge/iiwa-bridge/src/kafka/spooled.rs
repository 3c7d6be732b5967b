//! Spooled records, with the data needed to send them.

use crate::{
    encoding::JointFormat,
    message::{Kind, Message},
};

/// A Kafka record. Layout in the spool: kind, key length, time in µs, session, number, key, value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct SpooledRecord {
    pub(super) kind: Kind,
    pub(super) at_micros: u64,
    pub(super) session: u64,
    pub(super) seq: u64,
    /// The robot.
    pub(super) key: Vec<u8>,
    pub(super) value: Vec<u8>,
}

const HEAD: usize = 2 + 3 * 8;

impl SpooledRecord {
    pub(super) fn of(message: &Message, joints: JointFormat) -> Self {
        Self {
            kind: message.kind(),
            at_micros: message.at.micros(),
            session: message.session,
            seq: message.seq,
            key: message.robot.clone().into_bytes(),
            value: joints.encode(message),
        }
    }

    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let Self { kind, at_micros, session, seq, key, value } = self;
        let mut bytes = Vec::with_capacity(HEAD + key.len() + value.len());
        // Robot names have up to 64 bytes, and the number of kinds is small.
        bytes.push(u8::try_from(kind.index()).unwrap_or(u8::MAX));
        bytes.push(u8::try_from(key.len()).unwrap_or(u8::MAX));
        for number in [at_micros, session, seq] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        bytes.extend_from_slice(key);
        bytes.extend_from_slice(value);
        bytes
    }

    /// Decodes a record; `None` if it was not written by this version.
    pub(super) fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (&kind, rest) = bytes.split_first()?;
        let (&key_length, rest) = rest.split_first()?;
        let (at_micros, rest) = number(rest)?;
        let (session, rest) = number(rest)?;
        let (seq, rest) = number(rest)?;
        let (key, value) = rest.split_at_checked(usize::from(key_length))?;
        let kind = *Kind::ALL.get(usize::from(kind))?;
        Some(Self { kind, at_micros, session, seq, key: key.to_owned(), value: value.to_owned() })
    }
}

fn number(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let (number, rest) = bytes.split_first_chunk::<8>()?;
    Some((u64::from_le_bytes(*number), rest))
}
