//! Records in lines: a table, or one JSON object per line.

use std::{
    collections::HashMap,
    io::{self, BufRead},
};

use serde_json::{Map, Number, Value};

use crate::{
    encoding::{UTF_16, is_utf16},
    excerpt::excerpt,
    fields::fields,
    table_header::{HeaderFault, HeaderSearch, TableHeader, TableLine},
    text_lines::{TextLine, TextLines},
};

/// Records of a stream, each with its line number, or the reason why the line is invalid.
///
/// A line that begins with `{` is a JSON object. Other lines are rows of a table with `,`, `;`,
/// tabs or spaces between the fields, whose first line names the columns. Blank lines, comments
/// (`#`, `%`) and Excel's `sep=` are skipped. The line of column names may be a comment itself, as
/// `numpy` and MATLAB write it.
#[derive(Debug)]
pub struct Records<R, C> {
    lines: TextLines<R>,
    table: RecordTable<C>,
}

/// Table of the records that are not JSON.
#[derive(Debug)]
struct RecordTable<C> {
    /// Selects the columns by their names.
    choose: C,
    search: HeaderSearch,
    header: Option<RecordHeader>,
}

/// A column that is read: its values become values of this key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordColumn {
    /// Key in the record.
    pub key: String,
    /// `true` for a text, `false` for a number.
    pub is_text: bool,
}

#[derive(Debug)]
struct RecordHeader {
    delimiter: char,
    /// Names of the columns, with their meaning; `None` for columns that are skipped.
    columns: Vec<(String, Option<RecordColumn>)>,
}

impl<R, C> Records<R, C>
where
    R: BufRead,
    C: FnMut(&[String]) -> Result<Vec<Option<RecordColumn>>, String>,
{
    /// Reads the records of `stream`. `choose` receives the column names of a table, and returns
    /// the meaning of each column, or the reason why they are not those of the table.
    pub fn new(stream: R, choose: C) -> Self {
        let table = RecordTable { choose, search: HeaderSearch::default(), header: None };
        Self { lines: TextLines::new(stream), table }
    }
}

impl<C> RecordTable<C>
where
    C: FnMut(&[String]) -> Result<Vec<Option<RecordColumn>>, String>,
{
    /// Parses a line; `None` for a line without a record. The outer error ends the reading.
    fn parse(&mut self, line: &TextLine<'_>) -> Result<Option<ReadRecord>, String> {
        if line.number == 1 && is_utf16(line.text) {
            return Err(format!("line 1: {UTF_16}"));
        }
        if line.text.trim_ascii_start().starts_with(b"{") {
            let record = serde_json::from_slice(line.text);
            return Ok(Some(record.map_err(|error| error.to_string())));
        }
        if self.header.is_none() {
            let choose = &mut self.choose;
            let header = self.search.examine(line, |names| choose(names).is_ok());
            let header = header.map_err(|fault| format!("line {}: {fault}", line.number))?;
            let Some(header) = header else { return Ok(None) };
            let number = header.line;
            let header = RecordHeader::new(header, choose);
            self.header = Some(header.map_err(|message| format!("line {number}: {message}"))?);
            if number == line.number {
                return Ok(None);
            }
        }
        let (Some(header), TableLine::Row(row)) = (&self.header, TableLine::of(line.text)) else {
            return Ok(None);
        };
        // Fields that are read are ASCII; in other fields, the encoding makes no difference.
        Ok(Some(header.record(&String::from_utf8_lossy(row))))
    }
}

type ReadRecord = Result<Map<String, Value>, String>;

impl RecordHeader {
    fn new(
        header: TableHeader,
        choose: impl FnOnce(&[String]) -> Result<Vec<Option<RecordColumn>>, String>,
    ) -> Result<Self, String> {
        let TableHeader { delimiter, names, .. } = header;
        if names.is_empty() {
            return Err(HeaderFault::Numbers.to_string());
        }
        let columns = choose(&names)?;
        let mut owners = HashMap::new();
        for (name, column) in names.iter().zip(&columns) {
            let Some(RecordColumn { key, .. }) = column else { continue };
            if let Some(other) = owners.insert(key, name) {
                let [other, name] = [other, name].map(|name| excerpt(name));
                return Err(format!("the columns `{other}` and `{name}` are both `{key}`"));
            }
        }
        let columns = names.into_iter().zip(columns).collect();
        Ok(Self { delimiter: char::from(delimiter), columns })
    }

    fn record(&self, line: &str) -> ReadRecord {
        let mut fields = fields(line, self.delimiter)?;
        let expected = self.columns.len();
        if fields.len() == expected + 1 {
            // A line may end with a delimiter.
            fields.pop_if(|last| last.is_empty());
        }
        if fields.len() != expected {
            let hint = if self.delimiter == ',' && fields.len() > expected {
                "; numbers need a decimal point, not a comma"
            } else {
                ""
            };
            return Err(format!("{} fields, and {expected} columns{hint}", fields.len()));
        }
        let mut record = Map::new();
        for ((name, column), field) in self.columns.iter().zip(fields) {
            // Empty fields are left out.
            let Some(RecordColumn { key, is_text }) = column.as_ref().filter(|_| !field.is_empty())
            else {
                continue;
            };
            let value = if *is_text {
                Value::String(field)
            } else {
                Value::Number(
                    number(&field).map_err(|fault| format!("{}: {fault}", excerpt(name)))?,
                )
            };
            record.insert(key.clone(), value);
        }
        Ok(record)
    }
}

/// Reads a number. Whole numbers are integers, also if the table shows decimals.
fn number(field: &str) -> Result<Number, String> {
    /// Bound up to which an `f64` represents all integers.
    const EXACT: f64 = 9e15;
    let value = field.parse::<f64>().ok().filter(|value| value.is_finite());
    let Some(value) = value else {
        let with_point = field.replacen(',', ".", 1);
        let has_comma = with_point != field && with_point.parse::<f64>().is_ok();
        let hint = if has_comma { "; it needs a decimal point, not a comma" } else { "" };
        return Err(format!("`{}` is not a number{hint}", excerpt(field)));
    };
    #[expect(clippy::cast_possible_truncation, reason = "it is a whole number of few digits")]
    let whole = (value.fract() == 0.0 && value.abs() < EXACT).then_some(value as i64);
    let number = whole.map(Number::from).or_else(|| Number::from_f64(value));
    number.ok_or_else(|| format!("`{}` is not a number", excerpt(field)))
}

impl<R, C> Iterator for Records<R, C>
where
    R: BufRead,
    C: FnMut(&[String]) -> Result<Vec<Option<RecordColumn>>, String>,
{
    type Item = io::Result<(u64, ReadRecord)>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let line = match self.lines.next_line() {
                Ok(line) => line?,
                Err(error) => return Some(Err(error)),
            };
            match self.table.parse(&line) {
                Ok(None) => {}
                Ok(Some(record)) => return Some(Ok((line.number, record))),
                // Without column names, no line of the table is readable.
                Err(message) => {
                    return Some(Err(io::Error::new(io::ErrorKind::InvalidData, message)));
                }
            }
        }
    }
}
