//! Joint positions and torques of a table: CSV, and the format of a `DataRecorder`.

use std::io::{self, Cursor, Read};

use csv::{ByteRecord, ReaderBuilder};
use memchr::memchr2;

use super::columns::{ColumnRole, Columns, are_columns};
use super::lines::{TextLine, TextLines};
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
    let layout = header.layout();
    let columns = Columns::new(header.line, header.names()?, options)?;

    let mut samples = SampleCollector::new(columns.source, columns.units());
    samples.log().robot.clone_from(&columns.robot);
    let mut lines = TextLines::after(header.line, Cursor::new(&head[header.end..]).chain(stream));
    let mut origin = None;
    let mut cut_off = None;
    while let Some(line) = lines.next()? {
        if line.text.trim_ascii().is_empty() || line.text.starts_with(b"#") {
            continue;
        }
        if !line.is_complete {
            cut_off = Some(Loss::LastLine { line: line.number });
            break;
        }
        let row = TableRow::parse(&columns, layout, &line)?;
        samples.push(FilePlace::Line(line.number), row.t_s(&mut origin), row.positions)?;
        if columns.has_torques() {
            samples.add_torques(row.measured_nm);
        }
    }
    let log = samples.finish(cut_off)?;
    log.check_units()?;
    Ok(log)
}

/// Line of column names.
struct TableHeader<'a> {
    /// Number of the line, from 1.
    line: u64,
    text: &'a [u8],
    /// Offset of the first line of data.
    end: usize,
}

/// Returns the first line that is neither blank, nor a comment, nor Excel's `sep=`. The header may
/// be a comment itself, as MATLAB and numpy write it: one with the names of columns, or the last
/// comment before a line of numbers.
fn header(head: &[u8]) -> Result<TableHeader<'_>, JointLogError> {
    let unknown = |found: String| Err(JointLogError::Unknown { found });
    if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") {
        return unknown("text in UTF-16: save it as UTF-8".to_owned());
    }
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let (mut end, mut line) = (head.len() - text.len(), 0);
    let mut last_comment = None;
    while end < head.len() {
        let (text, next) = next_line(head, end);
        if next == head.len() && head.len() == HEAD_BYTES {
            return unknown(format!("none in the first {} KiB", HEAD_BYTES / 1024));
        }
        (end, line) = (next, line + 1);
        let text = text.trim_ascii();
        let comment = text.strip_prefix(b"#").or_else(|| text.strip_prefix(b"%"));
        let is_separator = text.len() <= 5 && text.to_ascii_lowercase().starts_with(b"sep=");
        if text.is_empty() || is_separator {
            continue;
        }
        let text = comment.unwrap_or(text).trim_ascii_start();
        let header = TableHeader { line, text, end };
        if comment.is_some() && !header.names().is_ok_and(|names| are_columns(&names)) {
            last_comment = Some(header);
            continue;
        }
        if let Some(comment) = last_comment.filter(|_| starts_with_number(text)) {
            return Ok(comment);
        }
        if text.iter().all(|byte| !byte.is_ascii_control() || *byte == b'\t') {
            return Ok(header);
        }
        return unknown(format!("`{}`", shown(text)));
    }
    Err(JointLogError::NoSamples)
}

/// Returns the line at `start`, which ends with CR, LF or both, and the start of the next one.
fn next_line(head: &[u8], start: usize) -> (&[u8], usize) {
    let rest = &head[start..];
    let length = memchr2(b'\r', b'\n', rest).unwrap_or(rest.len());
    let (line, end) = rest.split_at(length);
    let line_break = if end.starts_with(b"\r\n") { 2 } else { end.len().min(1) };
    (line, start + length + line_break)
}

fn starts_with_number(line: &[u8]) -> bool {
    let mut fields = line.split(|byte| b",; \t".contains(byte));
    fields.next().is_some_and(|field| number(field).is_some())
}

impl TableHeader<'_> {
    /// Delimiter of the fields; by default any number of spaces.
    fn layout(&self) -> Layout {
        let delimiter = [b';', b'\t', b','].into_iter().find(|d| self.text.contains(d));
        Layout { delimiter: delimiter.unwrap_or(b' ') }
    }

    fn names(&self) -> Result<Vec<String>, JointLogError> {
        let mut line = ByteRecord::new();
        let delimiter = self.layout().delimiter;
        let reader =
            ReaderBuilder::new().has_headers(false).delimiter(delimiter).from_reader(self.text);
        read_line(reader, &mut line)?;
        let fields = line.iter().map(<[u8]>::trim_ascii);
        let fields = fields.filter(|field| delimiter != b' ' || !field.is_empty());
        let names = fields.map(bare).map(|name| match name {
            // No known name is that long, and `shown` leaves known names unchanged.
            name if name.len() > MAX_NAME => String::new(),
            // Names that are read are ASCII; in others, UTF-8 or Latin-1 makes no difference.
            name => {
                name.iter().map(|byte| char::from(*byte)).flat_map(char::escape_debug).collect()
            }
        });
        let mut names: Vec<String> = names.collect();
        names.pop_if(|last| last.is_empty());
        if names.iter().any(|name| name.parse::<f64>().is_ok()) {
            let found = format!("numbers: `{}`", shown(self.text));
            return Err(JointLogError::Unknown { found });
        }
        Ok(names)
    }
}

fn read_line(mut table: csv::Reader<&[u8]>, line: &mut ByteRecord) -> Result<(), JointLogError> {
    match table.read_byte_record(line) {
        Ok(_) => Ok(()),
        // A line may have any bytes and any number of fields.
        Err(_) => Err(io::Error::from(io::ErrorKind::InvalidData).into()),
    }
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

/// Numbers of a line in the columns that are read.
#[derive(Debug, Default)]
struct TableRow {
    time_s: f64,
    /// Whole seconds and nanoseconds, where the time is in two columns.
    split: Option<[f64; 2]>,
    /// Positions, in the units of the file.
    positions: [f64; 7],
    /// Torques, Nm, with the controller's sign.
    measured_nm: [f64; 7],
}

impl TableRow {
    fn parse(
        columns: &Columns,
        layout: Layout,
        line: &TextLine<'_>,
    ) -> Result<Self, JointLogError> {
        let expected = columns.roles.len();
        let mut row = Self::default();
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
            if let Err(expected) = row.take(*role, field) {
                let column = columns.names[column].clone();
                return Err(JointLogError::Field {
                    line: line.number,
                    column,
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

    /// Stores a field. The error is the expected content.
    fn take(&mut self, role: ColumnRole, field: &[u8]) -> Result<(), &'static str> {
        if role == ColumnRole::PassedOver {
            return Ok(());
        }
        let value = number(field).ok_or("a finite number with a decimal point")?;
        match role {
            ColumnRole::Time => self.time_s = value,
            ColumnRole::Seconds if value.fract() != 0.0 || value.abs() > MAX_SECONDS => {
                return Err("a whole number of seconds");
            }
            ColumnRole::Seconds => self.split.get_or_insert_default()[0] = value,
            ColumnRole::Nanoseconds if value.fract() != 0.0 || !(0.0..1e9).contains(&value) => {
                return Err("a whole number of nanoseconds below 1000000000");
            }
            ColumnRole::Nanoseconds => self.split.get_or_insert_default()[1] = value,
            ColumnRole::Position(joint, _) => self.positions[joint] = value,
            ColumnRole::Exerted(joint) => self.measured_nm[joint] = 0.0 - value,
            ColumnRole::Measured(joint) => self.measured_nm[joint] = value,
            ColumnRole::PassedOver => {}
        }
        Ok(())
    }

    /// Time, s. If the time has two columns, it counts from `origin`, the first time: seconds since
    /// 1970 would leave too few digits for the fraction.
    fn t_s(&self, origin: &mut Option<[f64; 2]>) -> f64 {
        let Some([seconds, nanoseconds]) = self.split else { return self.time_s };
        let [first_seconds, first_nanoseconds] = *origin.get_or_insert([seconds, nanoseconds]);
        ((seconds - first_seconds) * 1e9 + (nanoseconds - first_nanoseconds)) / 1e9
    }
}

/// Upper bound on seconds: beyond any clock, and differences are still exact.
const MAX_SECONDS: f64 = 1e12;

/// Removes quotes around a field.
fn bare(field: &[u8]) -> &[u8] {
    let inner = field.strip_prefix(b"\"").and_then(|field| field.strip_suffix(b"\""));
    inner.unwrap_or(field)
}

fn number(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(bare(field)).ok()?;
    text.parse().ok().filter(|value: &f64| value.is_finite())
}
