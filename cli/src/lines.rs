//! Poses on standard input, one per line.

use std::io;

use iiwa_json::{RecordColumn, Records, excerpt};
use iiwa_log::{AngleUnit, joint_column};
use serde_json::{Map, Value};

use crate::failure::Failure;

/// Record of a line, or the reason why it is invalid, with the line number.
type ParsedLine = (u64, Result<Map<String, Value>, String>);

/// Meaning of the columns of a table, or the reason why their names are invalid.
type ReadColumns = Result<Vec<Option<RecordColumn>>, String>;

/// Iterates over the records of standard input; `columns` selects the columns of a table.
pub(crate) fn records(
    columns: fn(&[String]) -> ReadColumns,
) -> impl Iterator<Item = Result<ParsedLine, Failure>> {
    Records::new(io::stdin().lock(), columns).map(|record| {
        record.map_err(|error| match error.kind() {
            io::ErrorKind::InvalidData => Failure::input(format!("standard input, {error}")),
            _ => Failure::input(format!("cannot read standard input: {error}")),
        })
    })
}

/// Column of errors, in the tables that `fk` and `ik` print.
const ERROR: &str = "error";

/// Keys of frames, which are numbers.
const FRAME_KEYS: [&str; 13] = [
    "x_mm", "y_mm", "z_mm", "a_deg", "b_deg", "c_deg", "a_rad", "b_rad", "c_rad", "e1_deg",
    "e1_rad", "status", "turn",
];

/// Returns the meaning of the columns of a table of frames.
pub(crate) fn frame_columns(names: &[String]) -> ReadColumns {
    let columns = names.iter().map(|name| {
        let key = name.to_ascii_lowercase();
        let is_text = key == ERROR || key == "base";
        if is_text || FRAME_KEYS.contains(&&*key) {
            return Ok(Some(RecordColumn { key, is_text }));
        }
        let keys = "`x_mm`, `y_mm`, `z_mm`, `a_deg`, `b_deg`, `c_deg` (or `a_rad`, ...), \
                    `e1_deg`, `status`, `turn`, `base`";
        Err(format!("unknown column `{}`, expected {keys}", excerpt(name)))
    });
    columns.collect()
}

/// Returns the meaning of the columns of a table of joint positions. Other columns are skipped.
pub(crate) fn joint_columns(names: &[String]) -> ReadColumns {
    let column = |name: &String| {
        let key = name.to_ascii_lowercase();
        if key == ERROR {
            return Ok(Some(RecordColumn { key, is_text: true }));
        }
        let Some((index, unit)) = joint_column(name) else { return Ok(None) };
        let joint = index + 1;
        let unit = match unit {
            Some(AngleUnit::Degrees) => "deg",
            Some(AngleUnit::Radians) => "rad",
            None => {
                return Err(format!(
                    "the column `{}` states no unit: name it `joint_{joint}_deg` or \
                     `joint_{joint}_rad`",
                    excerpt(name)
                ));
            }
        };
        Ok(Some(RecordColumn { key: format!("joint_{joint}_{unit}"), is_text: false }))
    };
    let columns = names.iter().map(column).collect::<Result<Vec<_>, _>>()?;
    let has = |key: String| columns.iter().flatten().any(|column| column.key == key);
    let missing = |unit: &str| (1..=7).find(|joint| !has(format!("joint_{joint}_{unit}")));
    match (missing("deg"), missing("rad")) {
        (None, _) | (_, None) => Ok(columns),
        (Some(deg), Some(rad)) => {
            let (joint, unit) = if rad > deg { (rad, "rad") } else { (deg, "deg") };
            let found = excerpt(&names.join(" "));
            Err(format!("no column `joint_{joint}_{unit}`, found `{found}`"))
        }
    }
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
    // Output of `ik` in place of joint positions.
    if let Some(Value::String(error)) = object.get(ERROR) {
        return Err(error.clone());
    }
    numbers(f64::to_radians, "deg").or_else(|| numbers(|rad| rad, "rad")).unwrap_or_else(|| {
        Err("there is no `joints_deg`, `joints_rad` or `joint_1_deg`".to_owned())
    })
}
