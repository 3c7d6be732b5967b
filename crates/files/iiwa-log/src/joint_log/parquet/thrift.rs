//! Thrift's compact protocol, in which a Parquet file has its metadata
//! (<https://github.com/apache/thrift/blob/master/doc/specs/thrift-compact-protocol.md>).

use super::fault::ParquetFault;

/// Maximum nesting depth of values that are skipped.
const MAX_DEPTH: u8 = 32;

/// Type of a value, with the value of a boolean field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ThriftKind {
    Bool(bool),
    Byte,
    Integer,
    Double,
    Binary,
    List,
    Map,
    Struct,
    Uuid,
}

impl ThriftKind {
    fn of(code: u8) -> Result<Self, ParquetFault> {
        Ok(match code {
            1 => Self::Bool(true),
            2 => Self::Bool(false),
            3 => Self::Byte,
            4..=6 => Self::Integer,
            7 => Self::Double,
            8 => Self::Binary,
            9 | 10 => Self::List,
            11 => Self::Map,
            12 => Self::Struct,
            13 => Self::Uuid,
            _ => return Err(damaged()),
        })
    }
}

/// Reader of values. Each count and length is bounded by the bytes that follow it.
#[derive(Clone, Debug)]
pub(super) struct Thrift<'a> {
    bytes: &'a [u8],
}

impl<'a> Thrift<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    /// Bytes that have not been read.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.bytes
    }

    /// Reads the fields of a struct. `visit` receives the number and the type of each field, and
    /// reads its value or skips it.
    pub(super) fn fields(
        &mut self,
        mut visit: impl FnMut(&mut Self, i64, ThriftKind) -> Result<(), ParquetFault>,
    ) -> Result<(), ParquetFault> {
        let mut number = 0_i64;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Ok(());
            }
            let kind = ThriftKind::of(head & 0x0f)?;
            number = match head >> 4 {
                0 => self.zigzag()?,
                step => number.saturating_add(step.into()),
            };
            visit(self, number, kind)?;
        }
    }

    /// Reads the structs of a list.
    pub(super) fn structs(
        &mut self,
        kind: ThriftKind,
        mut visit: impl FnMut(&mut Self) -> Result<(), ParquetFault>,
    ) -> Result<(), ParquetFault> {
        let (count, element) = self.list(kind)?;
        if count > 0 && element != ThriftKind::Struct {
            return Err(damaged());
        }
        (0..count).try_for_each(|_| visit(self))
    }

    /// Reads an integer of any size.
    pub(super) fn integer(&mut self, kind: ThriftKind) -> Result<i64, ParquetFault> {
        match kind {
            ThriftKind::Integer => self.zigzag(),
            ThriftKind::Byte => Ok(i8::from_le_bytes([self.byte()?]).into()),
            _ => Err(damaged()),
        }
    }

    /// Reads an integer that is a count, length or offset.
    pub(super) fn size(&mut self, kind: ThriftKind) -> Result<u64, ParquetFault> {
        u64::try_from(self.integer(kind)?).map_err(|_| damaged())
    }

    /// Reads a text. Characters that are not UTF-8 are replaced.
    pub(super) fn text(&mut self, kind: ThriftKind) -> Result<String, ParquetFault> {
        match kind {
            ThriftKind::Binary => Ok(String::from_utf8_lossy(self.binary()?).into_owned()),
            _ => Err(damaged()),
        }
    }

    /// Skips a value.
    pub(super) fn skip(&mut self, kind: ThriftKind) -> Result<(), ParquetFault> {
        self.skip_below(kind, MAX_DEPTH)
    }

    fn skip_below(&mut self, kind: ThriftKind, depth: u8) -> Result<(), ParquetFault> {
        let depth = depth.checked_sub(1).ok_or_else(damaged)?;
        match kind {
            ThriftKind::Bool(_) => Ok(()),
            ThriftKind::Byte => self.take(1).map(drop),
            ThriftKind::Integer => self.varint().map(drop),
            ThriftKind::Double => self.take(8).map(drop),
            ThriftKind::Uuid => self.take(16).map(drop),
            ThriftKind::Binary => self.binary().map(drop),
            ThriftKind::Struct => self.fields(|reader, _, kind| reader.skip_below(kind, depth)),
            ThriftKind::List => {
                let (count, element) = self.list(kind)?;
                (0..count).try_for_each(|_| self.skip_element(element, depth))
            }
            ThriftKind::Map => {
                let count = self.varint()?;
                if count == 0 {
                    return Ok(());
                }
                let kinds = self.byte()?;
                let (key, value) = (ThriftKind::of(kinds >> 4)?, ThriftKind::of(kinds & 0x0f)?);
                // Each entry has at least two bytes.
                if count > self.bytes.len() as u64 {
                    return Err(damaged());
                }
                (0..count).try_for_each(|_| {
                    self.skip_element(key, depth)?;
                    self.skip_element(value, depth)
                })
            }
        }
    }

    /// Skips an element of a list or map, in which a boolean has a byte of its own.
    fn skip_element(&mut self, kind: ThriftKind, depth: u8) -> Result<(), ParquetFault> {
        match kind {
            ThriftKind::Bool(_) => self.take(1).map(drop),
            _ => self.skip_below(kind, depth),
        }
    }

    /// Reads the number and the type of the elements of a list.
    fn list(&mut self, kind: ThriftKind) -> Result<(u64, ThriftKind), ParquetFault> {
        if kind != ThriftKind::List {
            return Err(damaged());
        }
        let head = self.byte()?;
        let count = match head >> 4 {
            15 => self.varint()?,
            count => count.into(),
        };
        // Each element has at least one byte.
        if count > self.bytes.len() as u64 {
            return Err(damaged());
        }
        // An empty list may have no type.
        let element = if count == 0 { ThriftKind::Byte } else { ThriftKind::of(head & 0x0f)? };
        Ok((count, element))
    }

    fn zigzag(&mut self) -> Result<i64, ParquetFault> {
        self.varint().map(unzigzag)
    }

    fn varint(&mut self) -> Result<u64, ParquetFault> {
        let (value, length) = varint(self.bytes).ok_or_else(damaged)?;
        self.bytes = &self.bytes[length..];
        Ok(value)
    }

    fn binary(&mut self) -> Result<&'a [u8], ParquetFault> {
        let length = self.varint()?;
        self.take(usize::try_from(length).map_err(|_| damaged())?)
    }

    fn byte(&mut self) -> Result<u8, ParquetFault> {
        self.take(1).map(|bytes| bytes[0])
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], ParquetFault> {
        let (taken, rest) = self.bytes.split_at_checked(length).ok_or_else(damaged)?;
        self.bytes = rest;
        Ok(taken)
    }
}

fn damaged() -> ParquetFault {
    ParquetFault::new("damaged metadata")
}

/// Reads an integer of seven bits per byte (ULEB128), and returns it with its length; `None` if the
/// bytes end, or the integer has more than 64 bits.
pub(super) fn varint(bytes: &[u8]) -> Option<(u64, usize)> {
    let mut value = 0;
    for (index, byte) in bytes.iter().take(10).enumerate() {
        let bits = u64::from(byte & 0x7f);
        if index == 9 && bits > 1 {
            return None;
        }
        value |= bits << (7 * index);
        if byte & 0x80 == 0 {
            return Some((value, index + 1));
        }
    }
    None
}

/// Returns the signed integer of its zigzag code: 0, -1, 1, -2, ...
pub(super) fn unzigzag(code: u64) -> i64 {
    (code >> 1).cast_signed() ^ -(code & 1).cast_signed()
}
