//! Figures of a plan as entries of a metadata record.

use std::collections::BTreeMap;

use iiwa_plan::PlanFigures;
use serde_json::Value;

/// Converts the figures to entries, one per key: texts unchanged, all other values as JSON.
pub(crate) fn of_figures(figures: &PlanFigures) -> BTreeMap<String, String> {
    let Ok(Value::Object(object)) = serde_json::to_value(figures) else {
        return BTreeMap::new();
    };
    let text = |value| match value {
        Value::String(text) => text,
        other => other.to_string(),
    };
    object.into_iter().map(|(key, value)| (key, text(value))).collect()
}

/// Converts the entries to a JSON object: an entry that is valid JSON is parsed, any other entry is
/// a text.
pub(crate) fn to_json(entries: &BTreeMap<String, String>) -> Value {
    let value =
        |text: &String| serde_json::from_str(text).unwrap_or_else(|_| Value::String(text.clone()));
    Value::Object(entries.iter().map(|(key, text)| (key.clone(), value(text))).collect())
}
