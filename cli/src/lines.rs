//! Poses on standard input, one per line.

use std::io::{self, StdinLock};

use iiwa_json::Records;
use serde_json::{Map, Value};

use crate::failure::Failure;

/// Record of a line, or the reason why it is invalid, with the line number.
type ParsedLine = (usize, Result<Map<String, Value>, String>);

/// Iterates over the records of standard input.
pub(crate) fn records() -> impl Iterator<Item = Result<ParsedLine, Failure>> {
    let records: Records<StdinLock<'static>> = Records::new(io::stdin().lock());
    records.map(|record| {
        record.map_err(|error| match error.kind() {
            io::ErrorKind::InvalidData => Failure::input(format!("standard input, {error}")),
            _ => Failure::input(format!("cannot read standard input: {error}")),
        })
    })
}

/// Rounds a number for a table: without noise digits and negative zeros.
pub(crate) fn rounded(value: f64) -> f64 {
    (value * 1e12).round() / 1e12 + 0.0
}

/// Quotes a text in a table.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// Returns the joint positions of an object in rad: `joints_deg` or `joints_rad`, or a key per
/// joint, such as `joint_1_deg`.
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
