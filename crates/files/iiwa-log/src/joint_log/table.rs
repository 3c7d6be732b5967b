//! Joint positions and torques of a table: CSV, and the format of a `DataRecorder`.

use std::io::{BufReader, Read};

use iiwa_json::{
    HeaderFault, HeaderSearch, TableHeader, TableLine, TextLine, TextLines, UTF_16, is_utf16,
};

use super::columns::{ColumnRole, Columns, are_columns};
use super::row::LogRow;
use super::samples::SampleCollector;
use super::shown::{MAX_NAME, shown};
use super::{FilePlace, JointLog, JointLogError, LogOptions, Loss};

/// Bytes of a file that are used to detect its format. A longer header line is rejected.
pub(super) const HEAD_BYTES: usize = 64 * 1024;

/// Reads a table whose first bytes are `head`; `stream` contains the rest.
pub(super) fn read<R: Read>(
    head: &[u8],
    stream: R,
    options: LogOptions,
) -> Result<JointLog, JointLogError> {
    let header = header(head)?;
    let layout = Layout { delimiter: header.delimiter };
    let names = header.names.iter().map(|name| column_name(name)).collect();
    let columns = Columns::new(FilePlace::Line(header.line), names, options)?;

    let mut samples = SampleCollector::new(columns.source, columns.units());
    samples.log().robot.clone_from(&columns.robot);
    let mut lines = TextLines::new(BufReader::with_capacity(1 << 18, head.chain(stream)));
    let mut origin = None;
    let mut cut_off = None;
    while let Some(line) = lines.next_line()? {
        if line.number <= header.line || !matches!(TableLine::of(line.text), TableLine::Row(_)) {
            continue;
        }
        if !line.is_complete {
            cut_off = Some(Loss::LastLine { line: line.number });
            break;
        }
        let row = parse_row(&columns, layout, &line)?;
        samples.push(FilePlace::Line(line.number), row.t_s(&mut origin), row.positions)?;
        if columns.has_torques() {
            samples.add_torques(row.measured_nm);
        }
    }
    let log = samples.finish(cut_off)?;
    log.check_units()?;
    Ok(log)
}

/// Finds the line of column names in the first bytes of a file.
fn header(head: &[u8]) -> Result<TableHeader, JointLogError> {
    let unknown = |found: String| Err(JointLogError::Unknown { found });
    if is_utf16(head) {
        return unknown(UTF_16.to_owned());
    }
    let continues = head.len() == HEAD_BYTES;
    let mut lines = TextLines::new(head);
    let mut search = HeaderSearch::default();
    while let Some(line) = lines.next_line()? {
        if continues && !line.is_complete {
            break;
        }
        let text = line.text.trim_ascii();
        let is_binary = text.iter().any(|byte| byte.is_ascii_control() && *byte != b'\t');
        if is_binary && matches!(TableLine::of(line.text), TableLine::Row(_)) {
            return unknown(format!("`{}`", shown(text)));
        }
        match search.examine(&line, are_columns) {
            Ok(None) => {}
            Ok(Some(header)) => return Ok(header),
            Err(HeaderFault::Numbers) => return unknown(format!("numbers: `{}`", shown(text))),
            Err(HeaderFault::Quotes(_)) => return unknown(format!("`{}`", shown(text))),
        }
    }
    if continues {
        return unknown(format!("none in the first {} KiB", HEAD_BYTES / 1024));
    }
    Err(JointLogError::NoSamples)
}

/// Name of a column for messages. No known name is as long as [`MAX_NAME`] or changed by the
/// escapes.
fn column_name(name: &str) -> String {
    if name.len() > MAX_NAME { String::new() } else { name.escape_debug().collect() }
}

/// Field separation.
#[derive(Clone, Copy, Debug)]
struct Layout {
    /// Byte between fields; of spaces, any number.
    delimiter: u8,
}

impl Layout {
    /// Fields of a line. Numbers need no quotes: if quotes counted, a stray one would swallow the
    /// rest of the line.
    fn fields(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
        let fields = line.split(move |byte| *byte == self.delimiter).map(<[u8]>::trim_ascii);
        fields.filter(move |field| self.delimiter != b' ' || !field.is_empty())
    }
}

/// Reads the numbers of a line in the columns that are read.
fn parse_row(
    columns: &Columns,
    layout: Layout,
    line: &TextLine<'_>,
) -> Result<LogRow, JointLogError> {
    let expected = columns.roles.len();
    let mut row = LogRow::default();
    let mut count = 0;
    for field in layout.fields(line.text) {
        let column = count;
        let Some(role) = columns.roles.get(column) else {
            // A line may end with a delimiter.
            if column == expected && field.is_empty() {
                break;
            }
            return Err(JointLogError::FieldCount {
                line: line.number,
                found: layout.fields(line.text).count(),
                expected,
            });
        };
        count += 1;
        if *role == ColumnRole::PassedOver {
            continue;
        }
        let value = number(field).ok_or("a finite number with a decimal point");
        if let Err(expected) = value.and_then(|value| row.set(*role, value)) {
            return Err(JointLogError::Field {
                place: FilePlace::Line(line.number),
                column: columns.names[column].clone(),
                found: shown(field),
                expected,
            });
        }
    }
    if count < expected {
        return Err(JointLogError::FieldCount { line: line.number, found: count, expected });
    }
    Ok(row)
}

/// Removes quotes around a field.
fn bare(field: &[u8]) -> &[u8] {
    let inner = field.strip_prefix(b"\"").and_then(|field| field.strip_suffix(b"\""));
    inner.unwrap_or(field)
}

fn number(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(bare(field)).ok()?;
    text.parse().ok().filter(|value: &f64| value.is_finite())
}
