//! Pages of a column.

use super::{
    codec::unpack,
    fault::ParquetFault,
    thrift::{Thrift, ThriftKind},
};

/// Kind of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PageKind {
    Data,
    /// Data with uncompressed definition levels, of this length.
    DataV2 {
        levels: u64,
    },
    Dictionary,
    /// Any other page, such as an index.
    Other,
}

/// Header of a page.
#[derive(Clone, Copy, Debug)]
pub(super) struct PageHeader {
    pub(super) kind: PageKind,
    /// Number of values, with missing ones.
    pub(super) values: u64,
    pub(super) encoding: i64,
    /// Length of the contents, before and after compression.
    pub(super) size: u64,
    pub(super) packed: u64,
    crc: Option<u32>,
    is_compressed: bool,
}

impl PageHeader {
    /// Reads a header, and returns it with the bytes behind it.
    pub(super) fn read(bytes: &[u8]) -> Result<(Self, &[u8]), ParquetFault> {
        let mut thrift = Thrift::new(bytes);
        let mut header = Self {
            kind: PageKind::Other,
            values: 0,
            encoding: -1,
            size: 0,
            packed: 0,
            crc: None,
            is_compressed: true,
        };
        let (mut kind, mut levels, mut repetitions) = (-1, 0, 0);
        thrift.fields(|thrift, field, value| {
            match field {
                1 => kind = thrift.integer(value)?,
                2 => header.size = thrift.size(value)?,
                3 => header.packed = thrift.size(value)?,
                4 => {
                    // A checksum of 32 bits, stored as a signed integer.
                    let crc = thrift.integer(value)?;
                    header.crc = u32::try_from(crc & 0xffff_ffff).ok();
                }
                5 | 7 | 8 if value == ThriftKind::Struct => {
                    thrift.fields(|thrift, inner, value| {
                        match (field, inner, value) {
                            (_, 1, _) => header.values = thrift.size(value)?,
                            (5 | 7, 2, _) | (8, 4, _) => header.encoding = thrift.integer(value)?,
                            (8, 5, _) => levels = thrift.size(value)?,
                            (8, 6, _) => repetitions = thrift.size(value)?,
                            (8, 7, ThriftKind::Bool(is_compressed)) => {
                                header.is_compressed = is_compressed;
                            }
                            _ => thrift.skip(value)?,
                        }
                        Ok(())
                    })?;
                }
                _ => thrift.skip(value)?,
            }
            Ok(())
        })?;
        if repetitions > 0 {
            return Err(ParquetFault::new("repeated values in a column without lists"));
        }
        header.kind = match kind {
            0 => PageKind::Data,
            2 => PageKind::Dictionary,
            3 => PageKind::DataV2 { levels },
            _ => PageKind::Other,
        };
        Ok((header, thrift.rest()))
    }

    /// Returns the contents of the page, whose stored bytes are `stored`.
    pub(super) fn contents(&self, codec: i64, stored: &[u8]) -> Result<Vec<u8>, ParquetFault> {
        if self.crc.is_some_and(|crc| crc != crc32fast::hash(stored)) {
            return Err(ParquetFault::new("damaged page: its checksum differs"));
        }
        let PageKind::DataV2 { levels } = self.kind else {
            return unpack(codec, stored, length(self.size)?);
        };
        let (uncompressed, data) = stored
            .split_at_checked(length(levels)?)
            .ok_or_else(|| ParquetFault::new("the levels of a page are longer than the page"))?;
        let size = length(self.size)?.checked_sub(uncompressed.len());
        let size = size.ok_or_else(|| ParquetFault::new("the levels are longer than the page"))?;
        let codec = if self.is_compressed && size > 0 { codec } else { 0 };
        // A page of missing values has no data, in whatever compression.
        let data = if size == 0 { &[] } else { data };
        let mut contents = uncompressed.to_vec();
        contents.extend(unpack(codec, data, size)?);
        Ok(contents)
    }
}

fn length(bytes: u64) -> Result<usize, ParquetFault> {
    usize::try_from(bytes).map_err(|_| ParquetFault::new(format!("a page of {bytes} bytes")))
}
