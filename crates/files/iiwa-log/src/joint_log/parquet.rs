//! Joint positions of an Apache Parquet file, read as the table that it is.

use std::io::{self, Read, Write};

use bytes::Bytes;
use parquet::{
    errors::ParquetError,
    file::reader::{FileReader, SerializedFileReader},
    record::Field,
};

use super::{JointLog, JointLogError, LogOptions, table};

/// Reads a file that begins with `head` and goes on in `stream`.
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

/// The file's rows with commas between the fields, numbers to the last bit.
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
                // Passed over, or refused where a number is needed.
                _ => text.push(b'?'),
            }
        }
        text.push(b'\n');
    }
    Ok(text)
}
