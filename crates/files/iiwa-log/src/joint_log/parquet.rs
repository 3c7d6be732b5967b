//! Joint positions of an Apache Parquet file, read via a CSV table.

use std::io::{self, Read, Write};

use bytes::Bytes;
use parquet::{
    errors::ParquetError,
    file::reader::{FileReader, SerializedFileReader},
    record::Field,
};

use super::{JointLog, JointLogError, LogOptions, table};

/// Reads a file whose first bytes are `head`; `stream` contains the rest.
pub(super) fn read<R: Read>(
    mut head: Vec<u8>,
    mut stream: R,
    options: LogOptions,
) -> Result<JointLog, JointLogError> {
    stream.read_to_end(&mut head)?;
    let text = csv(head.into()).map_err(io::Error::other)?;
    let split = text.len().min(table::HEAD_BYTES);
    table::read(&text[..split], &text[split..], options)
}

/// Converts the rows to CSV; numbers are exact.
fn csv(file: Bytes) -> Result<Vec<u8>, ParquetError> {
    let reader = SerializedFileReader::new(file)?;
    let fields = reader.metadata().file_metadata().schema().get_fields();
    let names: Vec<&str> = fields.iter().map(|field| field.name()).collect();
    let mut text = Vec::new();
    writeln!(text, "{}", names.join(","))?;
    for row in reader.get_row_iter(None)? {
        for (index, (_, value)) in row?.get_column_iter().enumerate() {
            if index > 0 {
                text.push(b',');
            }
            match value {
                Field::Double(value) => write!(text, "{value:?}")?,
                Field::Float(value) => write!(text, "{value:?}")?,
                Field::Int(value) => write!(text, "{value}")?,
                Field::Long(value) => write!(text, "{value}")?,
                // Ignored, or rejected where a number is required.
                _ => text.push(b'?'),
            }
        }
        text.push(b'\n');
    }
    Ok(text)
}
