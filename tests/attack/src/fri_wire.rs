//! Minimal FRI decoder for commanded positions and set-points. It shares no code with the project's
//! decoder, so that faults of the latter become visible.

/// Decoded part of a monitoring message.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Monitoring {
    /// Commanded joint positions, in rad.
    pub(super) commanded_rad: Option<[f64; 7]>,
    /// Time stamp of the controller: seconds and nanoseconds.
    pub(super) stamp: Option<(u64, u64)>,
    /// State of the session; 4 is active commanding.
    pub(super) session: u64,
    /// Sequence number of the message.
    pub(super) sequence: u64,
}

/// Decoded part of a command message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Answer {
    /// Sequence number of the answered monitoring message.
    pub(super) sequence: u64,
    /// Set-point, in rad.
    pub(super) joints_rad: [f64; 7],
}

/// Value of a field.
enum Value<'a> {
    Number(u64),
    Double(f64),
    Bytes(&'a [u8]),
}

/// Decodes a monitoring message; `None` if it is malformed.
pub(super) fn monitoring(datagram: &[u8]) -> Option<Monitoring> {
    let mut read = Monitoring::default();
    for_each(datagram, |number, value| {
        match (number, value) {
            (1, Value::Bytes(header)) => for_each(header, |number, value| {
                if let (2, Value::Number(sequence)) = (number, value) {
                    read.sequence = sequence;
                }
                Some(())
            })?,
            (3, Value::Bytes(data)) => for_each(data, |number, value| {
                match (number, value) {
                    (3, Value::Bytes(joints)) => read.commanded_rad = Some(joint_values(joints)?),
                    (15, Value::Bytes(stamp)) => read.stamp = Some(time_stamp(stamp)?),
                    _ => {}
                }
                Some(())
            })?,
            (4, Value::Bytes(connection)) => for_each(connection, |number, value| {
                if let (1, Value::Number(session)) = (number, value) {
                    read.session = session;
                }
                Some(())
            })?,
            _ => {}
        }
        Some(())
    })?;
    Some(read)
}

/// Decodes a command message; `None` if it is malformed or has no set-point.
pub(super) fn answer(datagram: &[u8]) -> Option<Answer> {
    let (mut reflected, mut joints_rad) = (None, None);
    for_each(datagram, |number, value| match (number, value) {
        (1, Value::Bytes(header)) => for_each(header, |number, value| {
            if let (3, Value::Number(sequence)) = (number, value) {
                reflected = Some(sequence);
            }
            Some(())
        }),
        (2, Value::Bytes(data)) => for_each(data, |number, value| {
            if let (1, Value::Bytes(joints)) = (number, value) {
                joints_rad = Some(joint_values(joints)?);
            }
            Some(())
        }),
        _ => Some(()),
    })?;
    Some(Answer { sequence: reflected?, joints_rad: joints_rad? })
}

/// Decodes seconds and nanoseconds.
fn time_stamp(bytes: &[u8]) -> Option<(u64, u64)> {
    let mut stamp = (0, 0);
    for_each(bytes, |number, value| {
        match (number, value) {
            (1, Value::Number(seconds)) => stamp.0 = seconds,
            (2, Value::Number(nanoseconds)) => stamp.1 = nanoseconds,
            _ => {}
        }
        Some(())
    })?;
    Some(stamp)
}

/// Decodes seven doubles, packed or with one tag per value.
fn joint_values(bytes: &[u8]) -> Option<[f64; 7]> {
    let mut values = Vec::with_capacity(7);
    for_each(bytes, |number, value| {
        match (number, value) {
            (1, Value::Double(value)) => values.push(value),
            (1, Value::Bytes(packed)) => {
                values.extend(
                    packed
                        .chunks_exact(8)
                        .filter_map(|eight| eight.try_into().ok().map(f64::from_le_bytes)),
                );
            }
            _ => {}
        }
        Some(())
    })?;
    values.try_into().ok()
}

/// Calls `take` with each field; `None` if a field is malformed.
fn for_each<'a>(
    mut bytes: &'a [u8],
    mut take: impl FnMut(u64, Value<'a>) -> Option<()>,
) -> Option<()> {
    while !bytes.is_empty() {
        let tag = varint(&mut bytes)?;
        let value = match tag & 7 {
            0 => Value::Number(varint(&mut bytes)?),
            1 => Value::Double(f64::from_le_bytes(cut(&mut bytes, 8)?.try_into().ok()?)),
            2 => {
                let length = usize::try_from(varint(&mut bytes)?).ok()?;
                Value::Bytes(cut(&mut bytes, length)?)
            }
            5 => {
                cut(&mut bytes, 4)?;
                continue;
            }
            _ => return None,
        };
        take(tag >> 3, value)?;
    }
    Some(())
}

fn cut<'a>(bytes: &mut &'a [u8], length: usize) -> Option<&'a [u8]> {
    let (head, tail) = bytes.split_at_checked(length)?;
    *bytes = tail;
    Some(head)
}

fn varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut value = 0;
    for place in 0..10 {
        let byte = *cut(bytes, 1)?.first()?;
        value |= u64::from(byte & 0x7f) << (7 * place);
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Encodes a length-delimited field.
    fn field(number: u8, content: &[u8]) -> Vec<u8> {
        [&[number << 3 | 2, u8::try_from(content.len()).unwrap()], content].concat()
    }

    #[test]
    fn a_message_is_read_packed_or_not() {
        let joints: [f64; 7] = std::array::from_fn(|j| j as f64 - 2.5);
        let each = joints.map(|q| [&[0x09], q.to_le_bytes().as_slice()].concat()).concat();
        let packed = field(1, &joints.map(f64::to_le_bytes).concat());
        let header = field(1, &[0x0d, 0x42, 0x51, 0x24, 0x00, 0x10, 9]);
        for values in [each, packed] {
            let stamp = field(15, &[0x08, 7, 0x10, 0x80, 1]);
            let data = field(3, &[field(3, &values), stamp].concat());
            let message = [header.clone(), data, field(4, &[0x08, 4, 0x10, 3])].concat();
            let read = monitoring(&message).unwrap();
            assert_eq!(
                read,
                Monitoring {
                    commanded_rad: Some(joints),
                    stamp: Some((7, 128)),
                    session: 4,
                    sequence: 9
                }
            );
            // A truncated message is never misread.
            for end in 0..message.len() {
                let cut = monitoring(&message[..end]).and_then(|read| read.commanded_rad);
                assert!(cut.is_none_or(|read| read == joints));
            }
            let header = field(1, &[0x0d, 0x01, 0x40, 0x03, 0x00, 0x10, 5, 0x18, 9]);
            let command = [header, field(2, &field(1, &values))].concat();
            assert_eq!(answer(&command).unwrap(), Answer { sequence: 9, joints_rad: joints });
        }
        // Six values are not a position.
        let short = field(3, &field(3, &[0x09; 54]));
        assert_eq!(monitoring(&short), None);
    }
}
