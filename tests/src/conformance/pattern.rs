//! Patterns of answers and states.

use serde_json::{Map, Value};

/// Describes the difference between `found` and a pattern; `None` if it matches. `found` is `None`
/// for an absent key.
#[must_use]
pub fn mismatch(pattern: &Value, found: Option<&Value>) -> Option<String> {
    let differs = |expected: &dyn std::fmt::Display| {
        let found = found.map_or_else(|| "nothing".to_owned(), Value::to_string);
        Some(format!("{found} instead of {expected}"))
    };
    match (pattern, found) {
        (Value::Null, None | Some(Value::Null)) => None,
        (Value::Object(object), _) if object.keys().any(|key| key.starts_with('$')) => {
            (!is_one(object, found)).then(|| differs(pattern)).flatten()
        }
        (Value::Object(keys), Some(Value::Object(found))) => keys
            .iter()
            .find_map(|(key, pattern)| Some((key, mismatch(pattern, found.get(key))?)))
            .map(|(key, what)| format!("{key}: {what}")),
        (Value::Array(patterns), Some(Value::Array(found))) => {
            if patterns.len() != found.len() {
                return Some(format!("{} elements instead of {}", found.len(), patterns.len()));
            }
            let mut both = (0..).zip(patterns.iter().zip(found));
            both.find_map(|(i, (pattern, found))| Some((i, mismatch(pattern, Some(found))?)))
                .map(|(i, what): (usize, String)| format!("{i}: {what}"))
        }
        (Value::Number(expected), Some(Value::Number(found))) => {
            let same = expected == found
                || expected.as_f64() == found.as_f64() && !is_whole(expected, found);
            (!same).then(|| differs(pattern)).flatten()
        }
        (_, Some(found)) if pattern == found => None,
        _ => differs(pattern),
    }
}

/// Returns true if both are written as integers: these are compared exactly.
fn is_whole(a: &serde_json::Number, b: &serde_json::Number) -> bool {
    [a, b].iter().all(|number| number.is_u64() || number.is_i64())
}

/// Returns true if `found` matches a pattern with one key such as `$has`.
fn is_one(pattern: &Map<String, Value>, found: Option<&Value>) -> bool {
    let text = found.and_then(Value::as_str);
    let contains = |part: &Value| match (text, part.as_str()) {
        (Some(text), Some(part)) => text.contains(part),
        _ => false,
    };
    pattern.len() == 1
        && pattern.iter().all(|(kind, argument)| match kind.as_str() {
            "$any" => found.is_some(),
            "$absent" => found.is_none(),
            "$has" => contains(argument),
            "$has_any" => argument.as_array().is_some_and(|parts| parts.iter().any(contains)),
            "$between" => {
                let bound = |i: usize| argument.get(i).and_then(Value::as_f64);
                match (bound(0), found.and_then(Value::as_f64), bound(1)) {
                    (Some(low), Some(found), Some(high)) => (low..=high).contains(&found),
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
    fn patterns_match_what_they_say() {
        let found = json!({"seq": 7, "error": {"code": "robot", "message": "stopped on request"},
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
            let what = mismatch(&pattern, Some(&found));
            assert_eq!(what.is_none(), matches, "{pattern}: {what:?}");
        }
    }
}
