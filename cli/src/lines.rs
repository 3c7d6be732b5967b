//! Many poses on standard input: a table with commas, or a JSON object a line.

use std::io::{self, BufRead, StdinLock};

use serde_json::{Map, Value};

use crate::failure::Failure;

/// The objects of standard input, each with its line's number, or why a line is none. Of a table, the names of the
/// columns are the keys.
pub(crate) struct Objects {
    lines: io::Lines<StdinLock<'static>>,
    number: usize,
    /// Of a table.
    header: Option<Vec<String>>,
}

impl Objects {
    pub(crate) fn on_stdin() -> Self {
        Self { lines: io::stdin().lock().lines(), number: 0, header: None }
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
            let (found, expected) = (fields.len(), header.len());
            return Err(format!("{found} fields, and {expected} columns"));
        }
        let value = |(name, field): (&String, &str)| match field {
            // Not given.
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

impl Iterator for Objects {
    type Item = Result<(usize, Result<Map<String, Value>, String>), Failure>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            self.number += 1;
            let line = match self.lines.next()? {
                Ok(line) => line,
                Err(error) => {
                    return Some(Err(Failure::input(format!(
                        "cannot read standard input: {error}"
                    ))));
                }
            };
            let line = line.trim_start_matches('\u{feff}').trim();
            if line.is_empty() {
                continue;
            }
            // No line of such a table can be read.
            let is_number = |name: &str| name.trim().parse::<f64>().is_ok();
            if self.header.is_none() && !line.starts_with('{') && line.split(',').any(is_number) {
                let what = "the first line has to name the columns";
                let place = format!("standard input, line {}", self.number);
                return Some(Err(Failure::input(format!("{place}: {what}"))));
            }
            match self.object(line) {
                Ok(None) => {}
                Ok(Some(object)) => return Some(Ok((self.number, Ok(object)))),
                Err(what) => return Some(Ok((self.number, Err(what)))),
            }
        }
    }
}

/// A number of a table: without digits that are noise, and no negative zero.
pub(crate) fn rounded(value: f64) -> f64 {
    (value * 1e12).round() / 1e12 + 0.0
}

/// A text in a table.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// The joints of an object in rad: `joints_deg` or `joints_rad`, or a key a joint, as `joint_1_deg`.
pub(crate) fn joints_rad(object: &Map<String, Value>) -> Result<[f64; 7], String> {
    let numbers = |to_rad: fn(f64) -> f64, unit: &str| -> Option<Result<[f64; 7], String>> {
        let given: Vec<&Value> = match object.get(&format!("joints_{unit}")) {
            Some(Value::Array(values)) => values.iter().collect(),
            Some(_) => return Some(Err(format!("`joints_{unit}` is not a list"))),
            None => {
                let key = |joint: usize| format!("joint_{joint}_{unit}");
                object.get(&key(1))?;
                (1..=7).filter_map(|joint| object.get(&key(joint))).collect()
            }
        };
        let values: Option<Vec<f64>> =
            given.iter().map(|value| value.as_f64().map(to_rad)).collect();
        let count = given.len();
        let joints = values.ok_or_else(|| "a joint is not a number".to_owned());
        Some(joints.and_then(|values| {
            values.try_into().map_err(|_| format!("there are {count} numbers, and seven joints"))
        }))
    };
    numbers(f64::to_radians, "deg").or_else(|| numbers(|rad| rad, "rad")).unwrap_or_else(|| {
        Err("there is no `joints_deg`, `joints_rad` or `joint_1_deg`".to_owned())
    })
}
