//! Plan rows in an Apache Parquet file.

use std::{
    fmt,
    io::{self, Write},
    sync::Arc,
};

use parquet::{
    basic::{Compression, Repetition, Type as Physical},
    data_type::{DoubleType, Int32Type},
    errors::ParquetError,
    file::{properties::WriterProperties, writer::SerializedFileWriter},
    schema::types::Type,
};

use super::row::{PlanRow, names};
/// Number of rows per group, which are held in memory until they are written: some 25 MB.
const GROUP: usize = 100_000;

/// File under construction.
pub(super) struct ParquetSheet<W: Write> {
    writer: SerializedFileWriter<W>,
    rows: Vec<PlanRow>,
}

impl<W: Write> fmt::Debug for ParquetSheet<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ParquetSheet").field("rows", &self.rows.len()).finish_non_exhaustive()
    }
}

impl<W: Write + Send> ParquetSheet<W> {
    pub(super) fn new(stream: W) -> io::Result<Self> {
        let field = |name: &str, physical| {
            let column = Type::primitive_type_builder(name, physical);
            column.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
        };
        let mut fields = vec![
            field("t_s", Physical::DOUBLE).map_err(refused)?,
            field("motion", Physical::INT32).map_err(refused)?,
        ];
        for name in names() {
            fields.push(field(&name, Physical::DOUBLE).map_err(refused)?);
        }
        let schema =
            Type::group_type_builder("plan").with_fields(fields).build().map_err(refused)?;
        let zstd = Compression::ZSTD(parquet::basic::ZstdLevel::default());
        let properties = WriterProperties::builder().set_compression(zstd).build();
        let writer = SerializedFileWriter::new(stream, Arc::new(schema), Arc::new(properties));
        Ok(Self { writer: writer.map_err(refused)?, rows: Vec::new() })
    }

    pub(super) fn push(&mut self, row: &PlanRow) -> io::Result<()> {
        self.rows.push(*row);
        if self.rows.len() >= GROUP { self.write_group() } else { Ok(()) }
    }

    pub(super) fn finish(mut self) -> io::Result<W> {
        self.write_group()?;
        self.writer.into_inner().map_err(refused)
    }

    fn write_group(&mut self) -> io::Result<()> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let mut group = self.writer.next_row_group().map_err(refused)?;
        let mut index = 0;
        while let Some(mut column) = group.next_column().map_err(refused)? {
            let written = if index == 1 {
                let number = |row: &PlanRow| i32::try_from(row.motion).unwrap_or(i32::MAX);
                let motions: Vec<i32> = self.rows.iter().map(number).collect();
                column.typed::<Int32Type>().write_batch(&motions, None, None)
            } else {
                let value = |row: &PlanRow| match index {
                    0 => row.t_s,
                    _ => row.values[index - 2],
                };
                let values: Vec<f64> = self.rows.iter().map(value).collect();
                column.typed::<DoubleType>().write_batch(&values, None, None)
            };
            written.map_err(refused)?;
            column.close().map_err(refused)?;
            index += 1;
        }
        group.close().map_err(refused)?;
        self.rows.clear();
        Ok(())
    }
}

fn refused(error: ParquetError) -> io::Error {
    io::Error::other(error)
}
