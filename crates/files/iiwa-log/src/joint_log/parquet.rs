//! Joint positions of an Apache Parquet file.
//!
//! Only the columns that are read are unpacked, one page of each at a time. Each length and count
//! of the file is checked before memory is allocated for it. The `parquet` crate, by which plans
//! are written, does neither: it panics on damaged levels and lengths, and unpacks pages to
//! whatever length they expand to.
//!
//! The time is proportional to the length of the file and the number of values: no byte is read
//! for two row groups.

mod codec;
mod column;
mod encoding;
mod fault;
#[cfg(test)]
mod handmade;
mod metadata;
mod number;
mod page;
mod thrift;

use std::io::Read;

use column::{ColumnReader, UnpackBudget};
use fault::ParquetFault;
use metadata::{ParquetColumn, ParquetMetadata};
use number::{Meaning, NumberType, StoredNumber};

use super::{
    FilePlace, JointLog, JointLogError, LogOptions,
    columns::{ColumnRole, Columns},
    row::LogRow,
    samples::SampleCollector,
    shown::{MAX_NAME, shown},
};

/// Largest file that is read, in bytes; it is held in memory.
const MAX_FILE_BYTES: u64 = 2 << 30;

/// Reads a file whose first bytes are `head`; `stream` contains the rest.
pub(super) fn read<R: Read>(
    mut head: Vec<u8>,
    stream: R,
    options: LogOptions,
) -> Result<JointLog, JointLogError> {
    stream.take(MAX_FILE_BYTES).read_to_end(&mut head)?;
    if head.len() as u64 > MAX_FILE_BYTES {
        let message = format!("the file has more than {MAX_FILE_BYTES} bytes");
        return Err(ParquetFault::new(message).into());
    }
    let metadata = ParquetMetadata::read(&head)?;
    let names = metadata.columns.iter().map(name).collect();
    let columns = Columns::new(FilePlace::Schema, names, options)?;
    let wanted = wanted(&metadata, &columns)?;

    let mut samples = SampleCollector::new(columns.source, columns.units());
    samples.log().robot.clone_from(&columns.robot);
    let mut budget = UnpackBudget::new(metadata.rows.saturating_mul(wanted.len() as u64));
    let mut number = 0;
    // Total length of the column chunks, which cannot overlap.
    let mut stored_bytes = 0_u64;
    let (mut origin, mut first_tick) = (None, None);
    for group in &metadata.groups {
        if group.rows == 0 {
            continue;
        }
        let mut readers = Vec::new();
        for column in &wanted {
            let in_column = |fault: ParquetFault| fault.at(&column.title());
            let chunk = group.chunk(column.schema).map_err(in_column)?;
            stored_bytes = stored_bytes.saturating_add(chunk.length);
            if stored_bytes > head.len() as u64 {
                let message = "the column chunks overlap: together, they are longer than the file";
                return Err(in_column(ParquetFault::new(message)).into());
            }
            let optional = column.schema.is_optional;
            let reader = ColumnReader::new(&head, column.numbers, optional, chunk);
            readers.push(reader.map_err(in_column)?);
        }
        for _ in 0..group.rows {
            number += 1;
            let place = FilePlace::Row(number);
            let mut row = LogRow::default();
            for (column, reader) in wanted.iter().zip(&mut readers) {
                let stored = reader
                    .next(&mut budget)
                    .map_err(|fault| fault.at(&format!("row {number}, {}", column.title())))?;
                let Some(stored) = stored else {
                    let column = column.name.to_owned();
                    return Err(JointLogError::Null { place, column });
                };
                let value = match (stored, column.numbers.meaning) {
                    // From the first sample on: a number in s since 1970 would lose digits.
                    (StoredNumber::Integer(tick), Meaning::Timestamp { per_s }) => {
                        (tick - *first_tick.get_or_insert(tick)) as f64 / per_s
                    }
                    _ => column.numbers.value(stored),
                };
                let error = |expected| JointLogError::Field {
                    place,
                    column: column.name.to_owned(),
                    found: format!("{value}"),
                    expected,
                };
                if !value.is_finite() {
                    return Err(error("a finite number"));
                }
                row.set(column.role, value).map_err(error)?;
            }
            samples.push(place, row.t_s(&mut origin), row.positions)?;
            if columns.has_torques() {
                samples.add_torques(row.measured_nm);
            }
        }
    }
    let log = samples.finish(None)?;
    log.check_units()?;
    Ok(log)
}

/// Column that is read.
struct WantedColumn<'a> {
    schema: &'a ParquetColumn,
    numbers: NumberType,
    role: ColumnRole,
    name: &'a str,
}

impl WantedColumn<'_> {
    fn title(&self) -> String {
        format!("column `{}`", self.name)
    }
}

fn wanted<'a>(
    metadata: &'a ParquetMetadata,
    columns: &'a Columns,
) -> Result<Vec<WantedColumn<'a>>, ParquetFault> {
    let mut wanted = Vec::new();
    for ((schema, role), name) in metadata.columns.iter().zip(&columns.roles).zip(&columns.names) {
        let refused = |kind: &str| {
            ParquetFault::new(format!("column `{name}` has the type {kind}: numbers are expected"))
        };
        let numbers = match (role, &schema.numbers) {
            (ColumnRole::PassedOver, _) => continue,
            (_, Err(kind)) => return Err(refused(kind)),
            (ColumnRole::Time, Ok(numbers)) => *numbers,
            (_, Ok(NumberType { meaning: Meaning::Timestamp { .. }, .. })) => {
                return Err(refused("TIMESTAMP"));
            }
            (_, Ok(numbers)) => *numbers,
        };
        wanted.push(WantedColumn { schema, numbers, role: *role, name });
    }
    Ok(wanted)
}

/// Name of a column, as those of other tables: without spaces around it.
fn name(column: &ParquetColumn) -> String {
    let name = column.name.trim();
    // No known name is that long.
    if name.len() > MAX_NAME { String::new() } else { shown(name.as_bytes()) }
}

#[cfg(test)]
mod tests {
    use super::{
        handmade::{HandmadeGroup, file, page},
        *,
    };

    /// Pages of all columns in a row group with one row.
    fn pages(t_s: f64) -> Vec<Vec<u8>> {
        // Most bytes are in a page that is skipped (kind 1: an index).
        let skipped = page(1, 1000, 0, 0, &[0; 1000]);
        let value = |value: f64| page(0, 8, 1, 0, &value.to_le_bytes());
        [t_s, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]
            .map(|number| [skipped.clone(), value(number)].concat())
            .into()
    }

    #[test]
    fn column_chunks_do_not_overlap() {
        let joints = (1..=7).map(|joint| format!("joint_{joint}_rad"));
        let names: Vec<_> = ["t_s".to_owned()].into_iter().chain(joints).collect();
        let read_all = |bytes| read(bytes, std::io::empty(), LogOptions::default());

        let first = HandmadeGroup { chunks: pages(0.0), rows: 1, at: None };
        let second = HandmadeGroup { chunks: pages(0.004), ..first.clone() };
        let log = read_all(file(&names, &[first.clone(), second.clone()])).unwrap();
        assert_eq!(log.t_s, [0.0, 0.004]);
        assert_eq!(log.q_rad[1], [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]);

        // The second group refers to the bytes of the first one.
        let second = HandmadeGroup { at: Some(4), ..second };
        let error = read_all(file(&names, &[first, second])).unwrap_err().to_string();
        assert!(error.contains("the column chunks overlap"), "{error}");
    }
}
