//! Patterns of answers and states.

use serde_json::{Map, Value};

/// Describes the difference between `actual` and a pattern; `None` if it matches. `actual` is
/// `None` for an absent key.
#[must_use]
pub fn mismatch(pattern: &Value, actual: Option<&Value>) -> Option<String> {
    let differs = |expected: &dyn std::fmt::Display| {
        let shown = actual.map_or_else(|| "nothing".to_owned(), Value::to_string);
        Some(format!("{shown} instead of {expected}"))
    };
    match (pattern, actual) {
        (Value::Null, None | Some(Value::Null)) => None,
        (Value::Object(object), _) if object.keys().any(|key| key.starts_with('$')) => {
            (!is_one(object, actual)).then(|| differs(pattern)).flatten()
        }
        (Value::Object(keys), Some(Value::Object(object))) => keys
            .iter()
            .find_map(|(key, pattern)| Some((key, mismatch(pattern, object.get(key))?)))
            .map(|(key, message)| format!("{key}: {message}")),
        (Value::Array(patterns), Some(Value::Array(values))) => {
            if patterns.len() != values.len() {
                return Some(format!("{} elements instead of {}", values.len(), patterns.len()));
            }
            let mut both = (0..).zip(patterns.iter().zip(values));
            both.find_map(|(i, (pattern, value))| Some((i, mismatch(pattern, Some(value))?)))
                .map(|(i, message): (usize, String)| format!("{i}: {message}"))
        }
        (Value::Number(expected), Some(Value::Number(number))) => {
            let same = expected == number
                || expected.as_f64() == number.as_f64() && !is_whole(expected, number);
            (!same).then(|| differs(pattern)).flatten()
        }
        (_, Some(value)) if pattern == value => None,
        _ => differs(pattern),
    }
}

/// Returns true if both are written as integers: these are compared exactly.
fn is_whole(a: &serde_json::Number, b: &serde_json::Number) -> bool {
    [a, b].iter().all(|number| number.is_u64() || number.is_i64())
}

/// Returns true if `actual` matches a pattern with one key such as `$has`.
fn is_one(pattern: &Map<String, Value>, actual: Option<&Value>) -> bool {
    let text = actual.and_then(Value::as_str);
    let contains = |part: &Value| match (text, part.as_str()) {
        (Some(text), Some(part)) => text.contains(part),
        _ => false,
    };
    pattern.len() == 1
        && pattern.iter().all(|(kind, argument)| match kind.as_str() {
            "$any" => actual.is_some(),
            "$absent" => actual.is_none(),
            "$has" => contains(argument),
            "$has_any" => argument.as_array().is_some_and(|parts| parts.iter().any(contains)),
            "$between" => {
                let bound = |i: usize| argument.get(i).and_then(Value::as_f64);
                match (bound(0), actual.and_then(Value::as_f64), bound(1)) {
                    (Some(low), Some(number), Some(high)) => (low..=high).contains(&number),
                    _ => false,
                }
            }
            _ => false,
        })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn patterns_match_as_documented() {
        let message = json!({"seq": 7, "error": {"code": "robot", "message": "stopped on request"},
            "io": [1.0, null, "x"], "big": u64::MAX});
        for (pattern, matches) in [
            (json!({}), true),
            (json!({"seq": 7}), true),
            (json!({"seq": 7.0}), true),
            (json!({"seq": 8}), false),
            (json!({"seq": "7"}), false),
            (json!({"value": null, "seq": 7}), true),
            (json!({"error": null}), false),
            (json!({"error": {"code": "robot"}}), true),
            (json!({"error": {"message": {"$has": "on request"}}}), true),
            (json!({"error": {"message": {"$has_any": ["a", "stop"]}}}), true),
            (json!({"error": {"message": {"$has_any": ["b", "c"]}}}), false),
            (json!({"seq": {"$has": "7"}}), false),
            (json!({"io": [1, null, {"$any": true}]}), true),
            (json!({"io": [1, null]}), false),
            (json!({"seq": {"$between": [7, 8]}}), true),
            (json!({"seq": {"$between": [7.5, 8]}}), false),
            (json!({"value": {"$absent": true}}), true),
            (json!({"seq": {"$absent": true}}), false),
            (json!({"value": {"$any": true}}), false),
            (json!({"seq": {"$like": 7}}), false),
            (json!({"big": u64::MAX}), true),
            (json!({"big": u64::MAX - 1}), false),
            (json!([]), false),
        ] {
            let difference = mismatch(&pattern, Some(&message));
            assert_eq!(difference.is_none(), matches, "{pattern}: {difference:?}");
        }
    }
}
