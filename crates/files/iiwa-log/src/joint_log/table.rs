//! Joint positions and torques of a table: CSV, and the format of a `DataRecorder`.

use std::io::{self, Cursor, Read};

use csv::{ByteRecord, ErrorKind, ReaderBuilder};

use super::columns::{ColumnRole, Columns};
use super::samples::SampleCollector;
use super::shown::{MAX_NAME, shown};
use super::{FilePlace, JointLog, JointLogError, LogOptions, Loss};
use crate::reader::read as read_once;

/// Bytes of a file that are used to detect its format. A longer header line is rejected.
pub(super) const HEAD_BYTES: usize = 64 * 1024;

/// Reads a table whose first bytes are `head`; `stream` contains the rest.
pub(super) fn read<R: Read>(
    head: &[u8],
    stream: R,
    options: LogOptions,
) -> Result<JointLog, JointLogError> {
    let TableHeader { line: header_line, text: header, end: data } = header(head)?;
    let delimiter = [b';', b'\t', b','].into_iter().find(|d| header.contains(d)).unwrap_or(b' ');
    let layout = Layout { spaces: delimiter == b' ' };
    let columns = Columns::new(header_line, names(header, delimiter, layout)?, options)?;

    let mut samples = SampleCollector::new(columns.source, columns.units());
    samples.log().robot.clone_from(&columns.robot);
    // Numbers need no quotes. If quotes counted, a stray one would swallow the following lines.
    let mut table = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(delimiter)
        .quoting(false)
        .buffer_capacity(1 << 18)
        .from_reader(LastByte { stream: Cursor::new(&head[data..]).chain(stream), last: b'\n' });
    let mut origin = None;
    let mut end = None;
    let (mut line, mut next) = (ByteRecord::new(), ByteRecord::new());
    let mut more = read_line(&mut table, &mut line)?;
    while more {
        more = read_line(&mut table, &mut next)?;
        if !layout.is_blank(&line) && !line.as_slice().starts_with(b"#") {
            let number = header_line + line.position().map_or(0, csv::Position::line);
            if !more && !matches!(table.get_ref().last, b'\n' | b'\r') {
                end = Some(Loss::LastLine { line: number });
                break;
            }
            let row = TableRow::parse(&columns, layout, number, &line)?;
            samples.push(FilePlace::Line(number), row.t_s(&mut origin), row.positions)?;
            if columns.has_torques() {
                samples.add_torques(row.measured_nm);
            }
        }
        std::mem::swap(&mut line, &mut next);
    }
    let log = samples.finish(end)?;
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
/// be a comment itself, as MATLAB and numpy write it: then a line of numbers follows.
fn header(head: &[u8]) -> Result<TableHeader<'_>, JointLogError> {
    let unknown = |found: String| Err(JointLogError::Unknown { found });
    if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") {
        return unknown("text in UTF-16: save it as UTF-8".to_owned());
    }
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let (mut end, mut line) = (head.len() - text.len(), 0);
    loop {
        if end == head.len() {
            return Err(JointLogError::NoSamples);
        }
        let (text, next) = next_line(head, end);
        (end, line) = (next, line + 1);
        let text = text.trim_ascii();
        let comment = text.strip_prefix(b"#").or_else(|| text.strip_prefix(b"%"));
        let is_separator = text.len() <= 5 && text.to_ascii_lowercase().starts_with(b"sep=");
        let names_follow = || !starts_with_number(next_line(head, next).0);
        if text.is_empty() || is_separator || comment.is_some() && names_follow() {
            continue;
        }
        let text = comment.unwrap_or(text).trim_ascii_start();
        let is_text = text.iter().all(|byte| !byte.is_ascii_control() || *byte == b'\t');
        if is_text && text.len() < HEAD_BYTES {
            return Ok(TableHeader { line, text, end });
        }
        return unknown(format!("`{}`", shown(text)));
    }
}

/// Returns the line at `start`, which ends with CR, LF or both, and the start of the next one.
fn next_line(head: &[u8], start: usize) -> (&[u8], usize) {
    let rest = &head[start..];
    let length = rest.iter().position(|byte| b"\r\n".contains(byte)).unwrap_or(rest.len());
    let (line, end) = rest.split_at(length);
    let line_break = if end.starts_with(b"\r\n") { 2 } else { end.len().min(1) };
    (line, start + length + line_break)
}

fn starts_with_number(line: &[u8]) -> bool {
    let mut fields = line.trim_ascii_start().split(|byte| b",; \t".contains(byte));
    fields.next().is_some_and(|field| number(field).is_some())
}

fn names(header: &[u8], delimiter: u8, layout: Layout) -> Result<Vec<String>, JointLogError> {
    let mut line = ByteRecord::new();
    let mut table =
        ReaderBuilder::new().has_headers(false).delimiter(delimiter).from_reader(header);
    read_line(&mut table, &mut line)?;
    let names = layout.fields(&line).map(bare).map(|name| match name {
        // No known name is that long, and `shown` leaves known names unchanged.
        name if name.len() > MAX_NAME => String::new(),
        // Names that are read are ASCII; in others, UTF-8 or Latin-1 makes no difference.
        name => name.iter().map(|byte| char::from(*byte)).flat_map(char::escape_debug).collect(),
    });
    let mut names: Vec<String> = names.collect();
    names.pop_if(|last| last.is_empty());
    if names.iter().any(|name| name.parse::<f64>().is_ok()) {
        let found = format!("numbers: `{}`", shown(header));
        return Err(JointLogError::Unknown { found });
    }
    Ok(names)
}

fn read_line<R: Read>(
    table: &mut csv::Reader<R>,
    line: &mut ByteRecord,
) -> Result<bool, JointLogError> {
    table.read_byte_record(line).map_err(|error| match error.into_kind() {
        ErrorKind::Io(source) => source.into(),
        // Lines may have any bytes and any number of fields.
        _ => io::Error::from(io::ErrorKind::InvalidData).into(),
    })
}

/// Field separation.
#[derive(Clone, Copy, Debug)]
struct Layout {
    /// `true` if any number of spaces separates fields.
    spaces: bool,
}

impl Layout {
    fn fields(self, line: &ByteRecord) -> impl Iterator<Item = &[u8]> {
        line.iter().map(<[u8]>::trim_ascii).filter(move |field| !self.spaces || !field.is_empty())
    }

    fn is_blank(self, line: &ByteRecord) -> bool {
        (self.spaces || line.len() < 2) && line.iter().all(|field| field.trim_ascii().is_empty())
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
        number: u64,
        line: &ByteRecord,
    ) -> Result<Self, JointLogError> {
        let expected = columns.roles.len();
        let mut row = Self::default();
        let mut count = 0;
        for field in layout.fields(line) {
            let column = count;
            let Some(role) = columns.roles.get(column) else {
                // A line may end with a delimiter.
                if column == expected && field.is_empty() {
                    break;
                }
                return Err(JointLogError::FieldCount {
                    line: number,
                    found: layout.fields(line).count(),
                    expected,
                });
            };
            count += 1;
            if let Err(expected) = row.take(*role, field) {
                let column = columns.names[column].clone();
                return Err(JointLogError::Field {
                    line: number,
                    column,
                    found: shown(field),
                    expected,
                });
            }
        }
        if count < expected {
            return Err(JointLogError::FieldCount { line: number, found: count, expected });
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

/// Stream that stores the last byte read.
struct LastByte<R> {
    stream: R,
    last: u8,
}

impl<R: Read> Read for LastByte<R> {
    fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
        let read = read_once(&mut self.stream, room)?;
        if let Some(last) = room[..read].last() {
            self.last = *last;
        }
        Ok(read)
    }
}
