//! Records in lines: a comma-separated table, or one JSON object per line.

use std::io::{self, BufRead};

use serde_json::{Map, Value};

/// Records of a stream, each with its line number, or the reason why the line is invalid. The
/// column names of a table are the keys.
#[derive(Debug)]
pub struct Records<R> {
    lines: io::Lines<R>,
    number: usize,
    /// Column names of a table.
    header: Option<Vec<String>>,
}

impl<R: BufRead> Records<R> {
    /// Reads the records of `stream`.
    pub fn new(stream: R) -> Self {
        Self { lines: stream.lines(), number: 0, header: None }
    }

    fn object(&mut self, line: &str) -> Result<Option<Map<String, Value>>, String> {
        if line.starts_with('{') {
            return serde_json::from_str(line).map(Some).map_err(|error| error.to_string());
        }
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let Some(header) = &self.header else {
            self.header = Some(fields.into_iter().map(str::to_owned).collect());
            return Ok(None);
        };
        if fields.len() != header.len() {
            let (count, expected) = (fields.len(), header.len());
            return Err(format!("{count} fields, and {expected} columns"));
        }
        let value = |(name, field): (&String, &str)| match field {
            // Empty fields are left out.
            "" => None,
            field => Some(
                serde_json::from_str::<serde_json::Number>(field)
                    .map(|number| (name.clone(), Value::Number(number)))
                    .map_err(|_| format!("{name}: `{field}` is not a number")),
            ),
        };
        header.iter().zip(fields).filter_map(value).collect::<Result<_, _>>().map(Some)
    }
}

impl<R: BufRead> Iterator for Records<R> {
    type Item = io::Result<(usize, Result<Map<String, Value>, String>)>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            self.number += 1;
            let line = match self.lines.next()? {
                Ok(line) => line,
                Err(error) => return Some(Err(error)),
            };
            let line = line.trim_start_matches('\u{feff}').trim();
            if line.is_empty() {
                continue;
            }
            // Without column names, no line of the table is readable.
            let is_number = |name: &str| name.trim().parse::<f64>().is_ok();
            if self.header.is_none() && !line.starts_with('{') && line.split(',').any(is_number) {
                let message =
                    format!("line {}: the first line has to name the columns", self.number);
                return Some(Err(io::Error::new(io::ErrorKind::InvalidData, message)));
            }
            match self.object(line) {
                Ok(None) => {}
                Ok(Some(object)) => return Some(Ok((self.number, Ok(object)))),
                Err(error) => return Some(Ok((self.number, Err(error)))),
            }
        }
    }
}
