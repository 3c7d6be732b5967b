//! Values of a column in a row group, page by page.

use super::{
    encoding::{Differences, Runs},
    fault::ParquetFault,
    metadata::ColumnChunk,
    number::{NumberType, Physical, StoredNumber},
    page::{PageHeader, PageKind},
};

/// Length of a page, in bytes, that is always accepted.
const SMALL_PAGE: u64 = 1 << 16;

/// Largest overhead of an encoding per value, in bytes.
const OVERHEAD: u64 = 8;

/// Largest number of bytes of a column that are unpacked at the same time, its dictionary and one
/// page. Some programs write one page per row group: there is room for a page with the maximum
/// number of rows of doubles.
const MAX_OPEN_BYTES: u64 = 80 << 20;

/// Number of bytes that may still be unpacked from a file.
#[derive(Debug)]
pub(super) struct UnpackBudget(u64);

impl UnpackBudget {
    /// Budget for a file with this number of values: many times what any writer produces for them,
    /// so that only files which are made to expand exceed it.
    pub(super) fn new(values: u64) -> Self {
        Self((64 << 20) + 48 * values)
    }

    fn spend(&mut self, bytes: u64) -> Result<(), ParquetFault> {
        self.0 = self.0.checked_sub(bytes).ok_or_else(|| {
            ParquetFault::new("its pages unpack to far more bytes than its values need")
        })?;
        Ok(())
    }
}

/// Reader of the values of a column chunk.
#[derive(Debug)]
pub(super) struct ColumnReader<'a> {
    numbers: NumberType,
    is_optional: bool,
    codec: i64,
    /// Pages that have not been read.
    pages: &'a [u8],
    /// Values of these pages.
    values: u64,
    dictionary: Option<Vec<u8>>,
    page: OpenPage,
}

/// Page that is being read.
#[derive(Debug)]
struct OpenPage {
    bytes: Vec<u8>,
    /// Values that follow, with missing ones.
    left: u64,
    levels: Option<Runs>,
    values: ValueDecoder,
}

#[derive(Debug)]
enum ValueDecoder {
    /// Offset of the next value.
    Plain(usize),
    Dictionary(Runs),
    Differences(Differences),
    /// Start of the bytes, number of values, next value.
    Split(usize, usize, usize),
}

impl<'a> ColumnReader<'a> {
    pub(super) fn new(
        file: &'a [u8],
        numbers: NumberType,
        is_optional: bool,
        chunk: ColumnChunk,
    ) -> Result<Self, ParquetFault> {
        let start = usize::try_from(chunk.start).ok();
        let length = usize::try_from(chunk.length).ok();
        let range =
            start.zip(length).and_then(|(start, length)| Some(start..start.checked_add(length)?));
        let pages = range.and_then(|range| file.get(range));
        let pages = pages.ok_or_else(|| ParquetFault::new("its pages are beyond the file"))?;
        let page =
            OpenPage { bytes: Vec::new(), left: 0, levels: None, values: ValueDecoder::Plain(0) };
        let (codec, values) = (chunk.codec, chunk.values);
        Ok(Self { numbers, is_optional, codec, pages, values, dictionary: None, page })
    }

    /// Reads the next value; `None` if it is missing (null).
    pub(super) fn next(
        &mut self,
        budget: &mut UnpackBudget,
    ) -> Result<Option<StoredNumber>, ParquetFault> {
        while self.page.left == 0 {
            self.open_page(budget)?;
        }
        self.page.left -= 1;
        let page = &mut self.page;
        if let Some(levels) = &mut page.levels {
            match levels.next(&page.bytes) {
                Some(0) => return Ok(None),
                Some(_) => {}
                None => return Err(ParquetFault::new("a page ends before its levels")),
            }
        }
        let length = self.numbers.physical.length();
        let value = match &mut page.values {
            ValueDecoder::Plain(at) => {
                let value = page.bytes.get(*at..*at + length);
                *at += length;
                value.and_then(|bytes| self.numbers.number(bytes))
            }
            ValueDecoder::Dictionary(runs) => runs.next(&page.bytes).and_then(|index| {
                let at = (index as usize).checked_mul(length)?;
                let bytes = self.dictionary.as_ref()?.get(at..at.checked_add(length)?)?;
                self.numbers.number(bytes)
            }),
            ValueDecoder::Differences(differences) => {
                differences.next(&page.bytes).map(|value| match self.numbers.physical {
                    // Differences of 32-bit integers wrap around at 32 bits.
                    #[expect(clippy::cast_possible_truncation, reason = "they wrap around")]
                    Physical::Int32 => self.numbers.integer((value as i32).into()),
                    _ => self.numbers.integer(value),
                })
            }
            ValueDecoder::Split(start, count, index) => {
                let mut bytes = [0; 16];
                let bytes = &mut bytes[..length];
                let all = bytes.iter_mut().enumerate().all(|(number, byte)| {
                    let found = page.bytes.get(*start + number * *count + *index);
                    *byte = found.copied().unwrap_or_default();
                    found.is_some() && *index < *count
                });
                *index += 1;
                all.then(|| self.numbers.number(bytes)).flatten()
            }
        };
        value.map(Some).ok_or_else(|| ParquetFault::new("a page ends before its values"))
    }

    /// Opens the next page; a dictionary is kept.
    fn open_page(&mut self, budget: &mut UnpackBudget) -> Result<(), ParquetFault> {
        if self.pages.is_empty() {
            return Err(ParquetFault::new("its pages end before its values"));
        }
        let (header, rest) = PageHeader::read(self.pages)?;
        let packed = usize::try_from(header.packed).ok();
        let stored = packed.and_then(|packed| rest.split_at_checked(packed));
        let (stored, rest) = stored.ok_or_else(|| {
            ParquetFault::new(format!("a page of {} bytes is beyond the column", header.packed))
        })?;
        self.pages = rest;
        let is_data = matches!(header.kind, PageKind::Data | PageKind::DataV2 { .. });
        if header.kind == PageKind::Other || (is_data && header.values == 0) {
            return Ok(());
        }
        // A dictionary may have values that no row refers to.
        if is_data && header.values > self.values {
            let message = format!(
                "a page states {} values, and the column has {}",
                header.values, self.values
            );
            return Err(ParquetFault::new(message));
        }
        let length = self.numbers.physical.length();
        let max = SMALL_PAGE.saturating_add(header.values.saturating_mul(length as u64 + OVERHEAD));
        if header.size > max {
            let message = format!(
                "a page of {} values unpacks to {} bytes; at most {max} are read",
                header.values, header.size
            );
            return Err(ParquetFault::new(message));
        }
        let dictionary = self.dictionary.as_ref().map_or(0, |bytes| bytes.len() as u64);
        if header.size > MAX_OPEN_BYTES.saturating_sub(dictionary) {
            let message = format!(
                "a page of {} bytes, with a dictionary of {dictionary}: at most {MAX_OPEN_BYTES} \
                 bytes are read at once; write smaller pages or row groups",
                header.size
            );
            return Err(ParquetFault::new(message));
        }
        // The memory of the previous page is free before the next page needs its own.
        self.page.bytes = Vec::new();
        budget.spend(header.size)?;
        let bytes = header.contents(self.codec, stored)?;
        if header.kind == PageKind::Dictionary {
            if self.dictionary.replace(bytes).is_some() {
                return Err(ParquetFault::new("the column has two dictionaries"));
            }
            if !matches!(header.encoding, 0 | 2) {
                return Err(not_supported(header.encoding));
            }
            return Ok(());
        }
        self.values -= header.values;
        let (levels, start) = self.levels(header.kind, &bytes)?;
        let values = self.decoder(header.encoding, &bytes, start)?;
        self.page = OpenPage { bytes, left: header.values, levels, values };
        Ok(())
    }

    /// Returns the decoder of the definition levels of a page, and the start of its values.
    fn levels(&self, kind: PageKind, bytes: &[u8]) -> Result<(Option<Runs>, usize), ParquetFault> {
        let cut_off = || ParquetFault::new("a page ends before its levels");
        let (start, length) = match kind {
            PageKind::DataV2 { levels } => (0, usize::try_from(levels).map_err(|_| cut_off())?),
            _ if !self.is_optional => return Ok((None, 0)),
            _ => {
                let length: &[u8; 4] = bytes.first_chunk().ok_or_else(cut_off)?;
                (4, u32::from_le_bytes(*length) as usize)
            }
        };
        let end = start + length;
        if end > bytes.len() {
            return Err(cut_off());
        }
        Ok((self.is_optional.then(|| Runs::new(start, end, 1)), end))
    }

    fn decoder(
        &self,
        encoding: i64,
        bytes: &[u8],
        start: usize,
    ) -> Result<ValueDecoder, ParquetFault> {
        let length = self.numbers.physical.length();
        let is_integer = matches!(self.numbers.physical, Physical::Int32 | Physical::Int64);
        Ok(match encoding {
            0 => ValueDecoder::Plain(start),
            2 | 8 => {
                // A page of missing values only may have no width.
                let width = bytes.get(start).copied().unwrap_or_default();
                if width > 32 {
                    return Err(ParquetFault::new("damaged page: more than 32 bits per index"));
                }
                ValueDecoder::Dictionary(Runs::new(
                    (start + 1).min(bytes.len()),
                    bytes.len(),
                    width.into(),
                ))
            }
            5 if is_integer => ValueDecoder::Differences(
                Differences::new(bytes, start)
                    .ok_or_else(|| ParquetFault::new("damaged page: invalid differences"))?,
            ),
            9 => {
                let count = bytes.len().saturating_sub(start) / length;
                ValueDecoder::Split(start, count, 0)
            }
            other => return Err(not_supported(other)),
        })
    }
}

fn not_supported(encoding: i64) -> ParquetFault {
    let name = match encoding {
        3 => "RLE",
        4 => "BIT_PACKED",
        5 => "DELTA_BINARY_PACKED",
        6 => "DELTA_LENGTH_BYTE_ARRAY",
        7 => "DELTA_BYTE_ARRAY",
        _ => "unknown",
    };
    ParquetFault::new(format!("the encoding {encoding} ({name}) of numbers is not supported"))
}

#[cfg(test)]
mod tests {
    use super::{
        super::{handmade::page, number::Meaning},
        *,
    };

    fn read(values: u64, pages: &[Vec<u8>]) -> Result<Vec<f64>, String> {
        let file = pages.concat();
        let numbers = NumberType { physical: Physical::Double, meaning: Meaning::Number };
        let mut chunk = ColumnChunk::default();
        (chunk.values, chunk.length) = (values, file.len() as u64);
        let mut column = ColumnReader::new(&file, numbers, false, chunk).unwrap();
        let mut budget = UnpackBudget::new(values);
        let next = |_| match column.next(&mut budget) {
            Ok(Some(stored)) => Ok(numbers.value(stored)),
            Ok(None) => Err("null".to_owned()),
            Err(fault) => Err(fault.to_string()),
        };
        (0..values).map(next).collect()
    }

    fn doubles(values: &[f64]) -> Vec<u8> {
        values.iter().flat_map(|value| value.to_le_bytes()).collect()
    }

    #[test]
    fn pages_follow_each_other() {
        let dictionary = page(2, 16, 2, 0, &doubles(&[1.5, 2.5]));
        // Width 1, one group of packed bits: 0, 1, 1.
        let indices = page(0, 3, 3, 8, &[1, 0x03, 0b110]);
        let empty = page(0, 0, 0, 0, &[]);
        let plain = page(0, 8, 1, 0, &doubles(&[-4.0]));
        assert_eq!(read(4, &[dictionary, indices, empty, plain]), Ok(vec![1.5, 2.5, 2.5, -4.0]));
    }

    #[test]
    fn lengths_and_counts_are_bounded() {
        let plain = |size, values| page(0, size, values, 0, &doubles(&[1.0]));
        let dictionary = || page(2, 8, 1, 0, &doubles(&[1.0]));
        for (values, pages, words) in [
            (1, vec![plain(2_000_000_000, 1)], "unpacks to 2000000000 bytes; at most 65552"),
            (1, vec![plain(8, 2)], "a page states 2 values, and the column has 1"),
            (2, vec![plain(8, 2)], "a page ends before its values"),
            (2, vec![plain(8, 1)], "its pages end before its values"),
            (1, vec![plain(9, 1)], "unpack to another length than 9"),
            (1, vec![dictionary(), dictionary()], "two dictionaries"),
            (1, vec![page(0, 8, 1, 7, &[0; 8])], "the encoding 7 (DELTA_BYTE_ARRAY)"),
            (1, vec![page(0, 8, 1, 8, &[40; 8])], "more than 32 bits"),
            // An index without a dictionary, and beyond it.
            (1, vec![page(0, 3, 1, 8, &[1, 2, 0])], "a page ends before its values"),
            (1, vec![dictionary(), page(0, 3, 1, 8, &[1, 2, 1])], "a page ends before its values"),
            (1, vec![vec![0x15, 0, 0x15, 0x10, 0x15, 0x80, 0x80, 0x01, 0]], "beyond the column"),
            // A negative length, and an integer of more than 64 bits.
            (1, vec![vec![0x15, 0, 0x15, 0x01, 0]], "damaged metadata"),
            (1, vec![[&[0x15][..], &[0xff; 12]].concat()], "damaged metadata"),
        ] {
            let error = read(values, &pages).unwrap_err();
            assert!(error.contains(words), "{error}: {words}");
        }
    }

    /// Pages that each unpack to an accepted length, and together to more than any writer produces.
    #[test]
    fn the_total_length_of_pages_is_bounded() {
        let contents = vec![0; 1 << 16];
        let one = page(0, SMALL_PAGE, 1, 0, &contents);
        assert_eq!(read(1000, &[one.repeat(1000)]), Ok(vec![0.0; 1000]));
        let error = read(1025, &[one.repeat(1025)]).unwrap_err();
        assert!(error.contains("far more bytes"), "{error}");
    }

    #[test]
    fn open_pages_are_bounded() {
        const ROWS: u64 = 10_000_000;
        let dictionary = || page(2, 8, 1, 0, &doubles(&[1.0]));
        for (pages, is_bounded) in [
            (vec![page(0, MAX_OPEN_BYTES + 1, ROWS, 0, &[])], true),
            (vec![page(2, MAX_OPEN_BYTES + 1, ROWS, 0, &[])], true),
            (vec![dictionary(), page(0, MAX_OPEN_BYTES - 7, ROWS, 0, &[])], true),
            // All doubles in one page; the contents are missing.
            (vec![dictionary(), page(0, 8 * ROWS, ROWS, 0, &[])], false),
        ] {
            let error = read(ROWS, &pages).unwrap_err();
            assert_eq!(error.contains("at most 83886080 bytes are read at once"), is_bounded);
            assert_eq!(error.contains("unpack to another length than"), !is_bounded, "{error}");
        }
        let many = page(2, 8, u64::MAX >> 1, 0, &doubles(&[1.0]));
        assert_eq!(read(1, &[many, page(0, 8, 1, 0, &doubles(&[2.0]))]), Ok(vec![2.0]));
    }

    #[test]
    fn dictionaries_may_have_unused_values() {
        let dictionary = page(2, 24, 3, 0, &doubles(&[1.5, 2.5, 3.5]));
        // Width 2, one group of packed bits: 2.
        let indices = page(0, 4, 1, 8, &[2, 0x03, 0b10, 0]);
        assert_eq!(read(1, &[dictionary, indices]), Ok(vec![3.5]));
    }
}
