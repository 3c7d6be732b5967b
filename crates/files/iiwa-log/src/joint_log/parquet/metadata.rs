//! Metadata at the end of a Parquet file: schema and row groups
//! (<https://github.com/apache/parquet-format>).

use super::{
    fault::ParquetFault,
    number::{Meaning, NumberType, Physical},
    thrift::{Thrift, ThriftKind},
};

/// Length of the footer: the length of the metadata and the magic number.
const FOOTER: usize = 8;

/// Largest number of rows that are read: 2.7 h at 1 kHz. A few bytes of a file can stand for any
/// number of rows.
const MAX_ROWS: u64 = 10_000_000;

/// Largest numbers of schema elements, of row groups and of column chunks in all groups. An element
/// of a list has one byte or more in the file, and up to a hundred in memory.
const MAX_ELEMENTS: usize = 100_000;
const MAX_GROUPS: usize = 100_000;
const MAX_CHUNKS: usize = 2_000_000;

/// Contents of a file.
#[derive(Debug)]
pub(super) struct ParquetMetadata {
    /// Number of rows in all groups.
    pub(super) rows: u64,
    /// Columns at the top level that have one value per row.
    pub(super) columns: Vec<ParquetColumn>,
    pub(super) groups: Vec<RowGroup>,
}

/// Column at the top level.
#[derive(Debug)]
pub(super) struct ParquetColumn {
    pub(super) name: String,
    /// Type of its numbers; the error is the name of another type.
    pub(super) numbers: Result<NumberType, String>,
    /// `true` if values may be missing.
    pub(super) is_optional: bool,
    /// Index of its chunks in the row groups.
    leaf: usize,
}

/// Rows that are stored together, with one chunk for each column.
#[derive(Debug)]
pub(super) struct RowGroup {
    pub(super) rows: u64,
    chunks: Vec<ColumnChunk>,
}

/// Pages of a column in a row group.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ColumnChunk {
    pub(super) codec: i64,
    pub(super) values: u64,
    /// Offset and length in the file.
    pub(super) start: u64,
    pub(super) length: u64,
    is_encrypted: bool,
    is_elsewhere: bool,
}

impl RowGroup {
    /// Returns the pages of a column.
    pub(super) fn chunk(&self, column: &ParquetColumn) -> Result<ColumnChunk, ParquetFault> {
        let chunk = self.chunks.get(column.leaf).copied();
        let chunk = chunk.ok_or_else(|| ParquetFault::new("a row group lacks the column"))?;
        if chunk.is_encrypted {
            return Err(ParquetFault::new("the column is encrypted"));
        }
        if chunk.is_elsewhere {
            return Err(ParquetFault::new("the column is in another file"));
        }
        if chunk.values != self.rows {
            let message = format!("{} values in a group of {} rows", chunk.values, self.rows);
            return Err(ParquetFault::new(message));
        }
        Ok(chunk)
    }
}

impl ParquetMetadata {
    /// Reads the metadata of a whole file.
    pub(super) fn read(file: &[u8]) -> Result<Self, ParquetFault> {
        let footer: Option<&[u8; FOOTER]> = file.last_chunk();
        let Some(&[a, b, c, d, ref magic @ ..]) = footer else {
            return Err(ParquetFault::new("the file is cut off"));
        };
        match magic {
            b"PAR1" => {}
            b"PARE" => return Err(ParquetFault::new("the file is encrypted")),
            _ => return Err(ParquetFault::new("the file is cut off: it does not end with `PAR1`")),
        }
        let length = u32::from_le_bytes([a, b, c, d]) as usize;
        let start = (file.len() - FOOTER).checked_sub(length);
        let start = start.ok_or_else(|| {
            ParquetFault::new(format!("the metadata has {length} bytes, more than the file"))
        })?;
        let mut thrift = Thrift::new(&file[start..file.len() - FOOTER]);
        let (mut rows, mut schema, mut groups) = (0, Vec::new(), Vec::new());
        let mut chunks = 0;
        thrift.fields(|thrift, field, kind| {
            match field {
                2 => thrift.structs(kind, |thrift| {
                    schema.push(SchemaElement::read(thrift)?);
                    check_count(schema.len(), MAX_ELEMENTS, "columns")
                })?,
                3 => rows = thrift.size(kind)?,
                4 => thrift.structs(kind, |thrift| {
                    groups.push(row_group(thrift, &mut chunks)?);
                    check_count(groups.len(), MAX_GROUPS, "row groups")
                })?,
                8 => return Err(ParquetFault::new("the file is encrypted")),
                _ => thrift.skip(kind)?,
            }
            Ok(())
        })?;
        let in_groups = groups.iter().try_fold(0_u64, |sum, group| sum.checked_add(group.rows));
        if in_groups != Some(rows) {
            let message = format!(
                "the file states {rows} rows, but its row groups have another number of rows"
            );
            return Err(ParquetFault::new(message));
        }
        if rows > MAX_ROWS {
            let message = format!("the file has {rows} rows; at most {MAX_ROWS} are read");
            return Err(ParquetFault::new(message));
        }
        Ok(Self { rows, columns: columns(&schema)?, groups })
    }
}

/// Column or group of columns.
#[derive(Debug, Default)]
struct SchemaElement {
    physical: Option<i64>,
    /// Length of values of a fixed length.
    length: u64,
    repetition: i64,
    name: String,
    children: u64,
    converted: Option<i64>,
    scale: i64,
    logical: Option<LogicalType>,
}

/// Logical type: its number in the union, and its parameters.
#[derive(Clone, Copy, Debug, Default)]
struct LogicalType {
    number: i64,
    scale: i64,
    /// Number of the time unit: 1 for ms, 2 for us, 3 for ns.
    time_unit: i64,
    is_unsigned: bool,
}

/// Repetition of values.
const OPTIONAL: i64 = 1;
const REPEATED: i64 = 2;

impl SchemaElement {
    fn read(thrift: &mut Thrift<'_>) -> Result<Self, ParquetFault> {
        let mut element = Self::default();
        thrift.fields(|thrift, field, kind| {
            match field {
                1 => element.physical = Some(thrift.integer(kind)?),
                2 => element.length = thrift.size(kind)?,
                3 => element.repetition = thrift.integer(kind)?,
                4 => element.name = thrift.text(kind)?,
                5 => element.children = thrift.size(kind)?,
                6 => element.converted = Some(thrift.integer(kind)?),
                7 => element.scale = thrift.integer(kind)?,
                10 if kind == ThriftKind::Struct => element.logical = LogicalType::read(thrift)?,
                _ => thrift.skip(kind)?,
            }
            Ok(())
        })?;
        Ok(element)
    }

    /// Returns the type of the numbers; the error is the name of another type.
    fn numbers(&self) -> Result<NumberType, String> {
        let physical = match self.physical {
            Some(1) => Physical::Int32,
            Some(2) => Physical::Int64,
            Some(4) => Physical::Float,
            Some(5) => Physical::Double,
            Some(7) if (1..=16).contains(&self.length) => {
                // At most 16.
                Physical::Fixed(usize::try_from(self.length).unwrap_or(16))
            }
            Some(0) => return Err("BOOLEAN".to_owned()),
            Some(3) => return Err("INT96".to_owned()),
            Some(6) => return Err(self.logical_name().unwrap_or("BYTE_ARRAY").to_owned()),
            Some(7) => return Err(format!("FIXED_LEN_BYTE_ARRAY({})", self.length)),
            other => return Err(format!("number {}", other.unwrap_or(-1))),
        };
        let is_integer = matches!(physical, Physical::Int32 | Physical::Int64);
        let logical = self.logical.unwrap_or_default();
        let scale = if self.logical.is_some() { logical.scale } else { self.scale };
        let meaning = match (self.logical.map(|it| it.number), self.converted) {
            (None, None) => Meaning::Number,
            (Some(5), _) | (None, Some(5))
                if is_integer || matches!(physical, Physical::Fixed(_)) =>
            {
                match i32::try_from(scale) {
                    Ok(scale) if (-400..=400).contains(&scale) => Meaning::Decimal { scale },
                    _ => return Err(format!("DECIMAL of scale {scale}")),
                }
            }
            (Some(10), _) if is_integer && logical.is_unsigned => Meaning::Unsigned,
            (None, Some(11..=14)) if is_integer => Meaning::Unsigned,
            (Some(10), _) | (None, Some(15..=18)) if is_integer => Meaning::Number,
            (Some(15), _) if physical == Physical::Fixed(2) => Meaning::Half,
            (Some(8), _) if physical == Physical::Int64 => match logical.time_unit {
                1 => Meaning::Timestamp { per_s: 1e3 },
                2 => Meaning::Timestamp { per_s: 1e6 },
                3 => Meaning::Timestamp { per_s: 1e9 },
                _ => return Err("TIMESTAMP of an unknown unit".to_owned()),
            },
            (None, Some(9)) if physical == Physical::Int64 => Meaning::Timestamp { per_s: 1e3 },
            (None, Some(10)) if physical == Physical::Int64 => Meaning::Timestamp { per_s: 1e6 },
            _ => return Err(self.logical_name().unwrap_or("of an unknown kind").to_owned()),
        };
        if meaning == Meaning::Number && matches!(physical, Physical::Fixed(_)) {
            return Err(format!("FIXED_LEN_BYTE_ARRAY({})", self.length));
        }
        Ok(NumberType { physical, meaning })
    }

    fn logical_name(&self) -> Option<&'static str> {
        Some(match (self.logical.map(|it| it.number), self.converted) {
            (Some(1), _) | (None, Some(0)) => "STRING",
            (Some(4), _) | (None, Some(4)) => "ENUM",
            (Some(5), _) | (None, Some(5)) => "DECIMAL",
            (Some(6), _) | (None, Some(6)) => "DATE",
            (Some(7), _) | (None, Some(7 | 8)) => "TIME",
            (Some(8), _) | (None, Some(9 | 10)) => "TIMESTAMP",
            (Some(11), _) => "NULL",
            (Some(12), _) | (None, Some(19)) => "JSON",
            (Some(13), _) | (None, Some(20)) => "BSON",
            (Some(14), _) => "UUID",
            (None, Some(21)) => "INTERVAL",
            _ => return None,
        })
    }
}

impl LogicalType {
    /// Reads a union of structs.
    fn read(thrift: &mut Thrift<'_>) -> Result<Option<Self>, ParquetFault> {
        let mut found = None;
        thrift.fields(|thrift, number, kind| {
            let mut logical = Self { number, ..Self::default() };
            if kind != ThriftKind::Struct {
                return thrift.skip(kind);
            }
            thrift.fields(|thrift, field, kind| {
                match (number, field, kind) {
                    (5, 1, _) => logical.scale = thrift.integer(kind)?,
                    (7 | 8, 2, ThriftKind::Struct) => thrift.fields(|thrift, unit, kind| {
                        logical.time_unit = unit;
                        thrift.skip(kind)
                    })?,
                    (10, 2, ThriftKind::Bool(is_signed)) => logical.is_unsigned = !is_signed,
                    _ => thrift.skip(kind)?,
                }
                Ok(())
            })?;
            found = Some(logical);
            Ok(())
        })?;
        Ok(found)
    }
}

/// Returns the columns at the top level. The schema is a tree in depth-first order.
fn columns(schema: &[SchemaElement]) -> Result<Vec<ParquetColumn>, ParquetFault> {
    let damaged = || ParquetFault::new("damaged schema");
    let (root, elements) = schema.split_first().ok_or_else(damaged)?;
    let mut columns = Vec::new();
    // Children that follow, for each group around the current element.
    let mut open = vec![root.children];
    let mut leaf = 0;
    for element in elements {
        while open.last() == Some(&0) {
            open.pop();
        }
        let depth = open.len();
        *open.last_mut().ok_or_else(damaged)? -= 1;
        if element.physical.is_none() {
            open.push(element.children);
            continue;
        }
        if depth == 1 && element.repetition != REPEATED {
            columns.push(ParquetColumn {
                name: element.name.clone(),
                numbers: element.numbers(),
                is_optional: element.repetition == OPTIONAL,
                leaf,
            });
        }
        leaf += 1;
    }
    if open.iter().any(|children| *children > 0) {
        return Err(damaged());
    }
    Ok(columns)
}

fn check_count(count: usize, max: usize, kind: &str) -> Result<(), ParquetFault> {
    if count > max {
        return Err(ParquetFault::new(format!("the file has more than {max} {kind}")));
    }
    Ok(())
}

/// Reads a row group. `chunks` is the number of column chunks in this group and all previous ones.
fn row_group(thrift: &mut Thrift<'_>, chunks: &mut usize) -> Result<RowGroup, ParquetFault> {
    let mut group = RowGroup { rows: 0, chunks: Vec::new() };
    thrift.fields(|thrift, field, kind| {
        match field {
            1 => thrift.structs(kind, |thrift| {
                group.chunks.push(column_chunk(thrift)?);
                *chunks += 1;
                check_count(*chunks, MAX_CHUNKS, "column chunks")
            })?,
            3 => group.rows = thrift.size(kind)?,
            _ => thrift.skip(kind)?,
        }
        Ok(())
    })?;
    Ok(group)
}

fn column_chunk(thrift: &mut Thrift<'_>) -> Result<ColumnChunk, ParquetFault> {
    let mut chunk = ColumnChunk::default();
    thrift.fields(|thrift, field, kind| {
        match field {
            1 => {
                chunk.is_elsewhere = true;
                thrift.skip(kind)?;
            }
            3 if kind == ThriftKind::Struct => {
                let (mut data, mut dictionary) = (0, None);
                thrift.fields(|thrift, field, kind| {
                    match field {
                        4 => chunk.codec = thrift.integer(kind)?,
                        5 => chunk.values = thrift.size(kind)?,
                        7 => chunk.length = thrift.size(kind)?,
                        9 => data = thrift.size(kind)?,
                        11 => dictionary = Some(thrift.size(kind)?),
                        _ => thrift.skip(kind)?,
                    }
                    Ok(())
                })?;
                // Some programs write 0 for a chunk without a dictionary.
                chunk.start = dictionary.filter(|start| (1..data).contains(start)).unwrap_or(data);
            }
            8 | 9 => {
                chunk.is_encrypted = true;
                thrift.skip(kind)?;
            }
            _ => thrift.skip(kind)?,
        }
        Ok(())
    })?;
    Ok(chunk)
}

#[cfg(test)]
mod tests {
    use super::{
        super::handmade::{list, with_footer},
        *,
    };

    /// File with a schema of one column, and one row group without chunks.
    fn file(name: &[u8], rows: &[u8]) -> Vec<u8> {
        let mut metadata = vec![0x29, 0x2c];
        // Root with one child; column of doubles.
        metadata.extend([0x48, 1, b'r', 0x15, 2, 0, 0x15, 10, 0x25, 0, 0x18]);
        metadata.push(u8::try_from(name.len()).unwrap());
        metadata.extend(name);
        metadata.push(0);
        metadata.push(0x16);
        metadata.extend(rows);
        metadata.extend([0x19, 0x1c, 0x36]);
        metadata.extend(rows);
        metadata.extend([0, 0]);
        with_footer(b"PAR1".to_vec(), &metadata)
    }

    #[test]
    fn schema_and_rows_are_read() {
        let metadata = ParquetMetadata::read(&file(b"q1", &[0x0a])).unwrap();
        assert_eq!((metadata.rows, metadata.groups.len()), (5, 1));
        let [column] = &metadata.columns[..] else { panic!() };
        assert_eq!((column.name.as_str(), column.is_optional), ("q1", false));
        let number = NumberType { physical: Physical::Double, meaning: Meaning::Number };
        assert_eq!(column.numbers, Ok(number));
        assert!(metadata.groups[0].chunk(column).is_err());
    }

    #[test]
    fn rows_and_lengths_are_bounded() {
        let refused = |file: &[u8]| ParquetMetadata::read(file).unwrap_err().to_string();
        // 20 000 000 rows.
        let message = refused(&file(b"q1", &[0x80, 0xb4, 0x89, 0x13]));
        assert_eq!(message, "the file has 20000000 rows; at most 10000000 are read");
        assert_eq!(refused(&file(b"q1", &[0x09])), "damaged metadata");
        let whole = file(b"q1", &[0x0a]);
        for length in 0..whole.len() {
            refused(&whole[..length]);
        }
        let mut long = whole;
        let end = long.len();
        long[end - 8..end - 4].fill(0xff);
        assert!(refused(&long).contains("4294967295 bytes, more than the file"));
    }
    /// Empty structs: one byte of the file each.
    #[test]
    fn lists_of_metadata_are_bounded() {
        let lists = |steps: &[u8], count: usize| {
            let mut metadata = Vec::new();
            for step in &steps[1..] {
                list(&mut metadata, *step, 1);
            }
            list(&mut metadata, steps[0], count);
            // The structs, and the ends of the structs around them.
            metadata.resize(metadata.len() + count + steps.len(), 0);
            ParquetMetadata::read(&with_footer(b"PAR1".to_vec(), &metadata))
                .map(|metadata| metadata.groups.len())
                .map_err(|fault| fault.to_string())
        };
        let refused = |words: &str| Err(format!("the file has more than {words}"));
        // Schema elements (field 2), row groups (4), column chunks (1) of a row group.
        assert_eq!(lists(&[2], 200_000), refused("100000 columns"));
        assert_eq!(lists(&[4], 200_000), refused("100000 row groups"));
        assert_eq!(lists(&[1, 4], 2_000_001), refused("2000000 column chunks"));
        for (steps, count) in [(&[2][..], 100_000), (&[4], 100_000), (&[1, 4], 100_000)] {
            assert_eq!(lists(steps, count), Err("damaged schema".to_owned()), "{steps:?}");
        }
    }
}
