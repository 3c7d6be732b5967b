//! Reading and schemas of numbers in scenes.

use iiwa_json::numbers;
use serde::Deserializer;

use crate::extent::MAX_M;

pub(super) fn position() -> serde_json::Value {
    let max_mm = 1e3 * MAX_M;
    serde_json::json!({ "type": "number", "minimum": -max_mm, "maximum": max_mm })
}

pub(super) fn size() -> serde_json::Value {
    serde_json::json!({ "type": "number", "minimum": 1e-3, "maximum": 1e3 * MAX_M })
}

pub(super) fn angle() -> serde_json::Value {
    serde_json::json!({ "type": "number", "minimum": -360, "maximum": 360 })
}

/// Converts mm to m. Division avoids the rounding of a factor of 1e-3: 100 mm are exactly the
/// number 0.1 m.
pub(super) fn from_mm(mm: f64) -> f64 {
    mm / 1e3
}

pub(super) fn three<'de, D: Deserializer<'de>>(reader: D) -> Result<[f64; 3], D::Error> {
    numbers(reader, "three numbers, for x, y and z")
}
