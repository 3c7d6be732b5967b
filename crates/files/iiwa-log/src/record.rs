//! Records of an MCAP file as bytes.

use std::collections::BTreeMap;
use std::io::Cursor;

use binrw::{BinWrite, BinWriterExt};
use mcap::McapError;
use mcap::records::{Channel, MessageHeader, SchemaHeader, op};

use crate::Topic;

/// Bytes of type and length, before the content of a record.
pub(crate) const RECORD_HEADER_BYTES: usize = 9;

/// Bytes of a message record without its data.
pub(crate) const MESSAGE_HEADER_BYTES: usize = RECORD_HEADER_BYTES + 22;

/// First record type that MCAP reserves for users; readers skip it.
pub(crate) const PADDING: u8 = 0x80;

/// Encodes type and length of a record.
pub(crate) fn record_header(opcode: u8, length: u64) -> [u8; RECORD_HEADER_BYTES] {
    let mut header = [opcode; RECORD_HEADER_BYTES];
    header[1..].copy_from_slice(&length.to_le_bytes());
    header
}

/// Appends a record with this content.
pub(crate) fn put(out: &mut Vec<u8>, opcode: u8, content: &[u8]) {
    out.extend(record_header(opcode, content.len() as u64));
    out.extend(content);
}

/// Appends a record.
pub(crate) fn put_record<T>(out: &mut Vec<u8>, opcode: u8, content: &T) -> Result<(), McapError>
where
    T: for<'a> BinWrite<Args<'a> = ()>,
{
    let start = out.len();
    out.extend(record_header(opcode, 0));
    append(out, content)?;
    let length = out.len() - start - RECORD_HEADER_BYTES;
    out[start..][..RECORD_HEADER_BYTES].copy_from_slice(&record_header(opcode, length as u64));
    Ok(())
}

/// Appends the content of a record.
pub(crate) fn append<T>(out: &mut Vec<u8>, content: &T) -> Result<(), McapError>
where
    T: for<'a> BinWrite<Args<'a> = ()>,
{
    let end = out.len() as u64;
    let mut cursor = Cursor::new(out);
    cursor.set_position(end);
    Ok(cursor.write_le(content)?)
}

/// Encodes a message up to its data. Written without a serializer, since a second of motion has
/// thousands of messages.
pub(crate) fn message_header(
    header: &MessageHeader,
    data_bytes: usize,
) -> [u8; MESSAGE_HEADER_BYTES] {
    let content = MESSAGE_HEADER_BYTES - RECORD_HEADER_BYTES + data_bytes;
    let mut bytes = [0; MESSAGE_HEADER_BYTES];
    bytes[..9].copy_from_slice(&record_header(op::MESSAGE, content as u64));
    bytes[9..11].copy_from_slice(&header.channel_id.to_le_bytes());
    bytes[11..15].copy_from_slice(&header.sequence.to_le_bytes());
    bytes[15..23].copy_from_slice(&header.log_time.to_le_bytes());
    bytes[23..].copy_from_slice(&header.publish_time.to_le_bytes());
    bytes
}

/// Appends the type of a topic.
pub(crate) fn put_schema(out: &mut Vec<u8>, topic: Topic) -> Result<(), McapError> {
    let header = SchemaHeader {
        id: topic.id(),
        name: topic.type_name().to_owned(),
        encoding: Topic::SCHEMA_ENCODING.to_owned(),
    };
    let text = topic.schema();
    let mut content = Vec::new();
    append(&mut content, &header)?;
    append(&mut content, &u32::try_from(text.len()).unwrap_or(u32::MAX))?;
    content.extend(text.as_bytes());
    put(out, op::SCHEMA, &content);
    Ok(())
}

/// Appends the channel of a topic.
pub(crate) fn put_channel(out: &mut Vec<u8>, topic: Topic) -> Result<(), McapError> {
    let qos = topic.offered_qos_profiles().to_owned();
    let channel = Channel {
        id: topic.id(),
        schema_id: topic.id(),
        topic: topic.name().to_owned(),
        message_encoding: Topic::MESSAGE_ENCODING.to_owned(),
        metadata: BTreeMap::from([("offered_qos_profiles".to_owned(), qos)]),
    };
    put_record(out, op::CHANNEL, &channel)
}
