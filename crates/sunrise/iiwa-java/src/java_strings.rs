//! Strings and string builders.

use std::rc::Rc;

use crate::{
    machine::Machine,
    stop::EvaluationStop,
    value::{Array, Value},
};

/// Maximum length of a string: longer ones would fill memory, and do not occur in robot programs.
pub(crate) const MAX_LETTERS: usize = 1_000_000;

impl Machine {
    /// Evaluates `String.name(...)`; `None` if it is not modelled.
    pub(crate) fn of_string_class(
        &mut self,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(Some(match (name, arguments) {
            ("valueOf" | "copyValueOf", [Value::Array(array)]) if array.element.name == "char" => {
                return Ok(Some(characters(array)));
            }
            ("valueOf" | "copyValueOf", [value]) => {
                let text = self.text_of(value)?;
                text.map_or_else(Value::Unknown, Value::text)
            }
            ("format", [Value::Text(format), rest @ ..]) => {
                let format = Rc::clone(format);
                // The arguments may be given as an array.
                let values = match rest {
                    [Value::Array(array)] => array.values.borrow().clone(),
                    _ => rest.to_vec(),
                };
                return self.formatted(&format, &values).map(Some);
            }
            // Overload with a locale.
            ("format", [_, Value::Text(format), rest @ ..]) => {
                let format = Rc::clone(format);
                return self.formatted(&format, rest).map(Some);
            }
            ("join", [Value::Text(between), rest @ ..]) => {
                let values = match rest {
                    [only] => only.elements().unwrap_or_else(|| rest.to_vec()),
                    _ => rest.to_vec(),
                };
                let mut texts = Vec::new();
                for value in &values {
                    match self.text_of(value)? {
                        Ok(text) => texts.push(text),
                        Err(unknown) => return Ok(Some(Value::Unknown(unknown))),
                    }
                }
                Value::text(texts.join(between))
            }
            _ => return Ok(None),
        }))
    }

    /// Calls a method of a string; `None` if it is not modelled. Indices count UTF-16 units, as in
    /// Java.
    pub(crate) fn of_string(
        &mut self,
        text: &Rc<str>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let units = || text.encode_utf16().collect::<Vec<u16>>();
        let count = |length: usize| Value::Int(i32::try_from(length).unwrap_or(i32::MAX));
        Ok(Some(match (name, arguments) {
            ("length", []) => count(text.encode_utf16().count()),
            ("isEmpty", []) => Value::Boolean(text.is_empty()),
            ("toString" | "intern", []) => Value::Text(Rc::clone(text)),
            ("trim", []) => Value::text(text.trim_matches(|c| c <= ' ')),
            ("strip", []) => Value::text(text.trim()),
            ("toUpperCase", _) => Value::text(text.to_uppercase()),
            ("toLowerCase", _) => Value::text(text.to_lowercase()),
            ("hashCode", []) => {
                let hash = text
                    .encode_utf16()
                    .fold(0_i32, |hash, unit| hash.wrapping_mul(31).wrapping_add(i32::from(unit)));
                Value::Int(hash)
            }
            ("equals", [Value::Text(other)]) => Value::Boolean(text == other),
            ("equals", [_]) => Value::Boolean(false),
            ("equalsIgnoreCase", [Value::Text(other)]) => {
                Value::Boolean(text.to_lowercase() == other.to_lowercase())
            }
            ("compareTo", [Value::Text(other)]) => {
                Value::Int(crate::java_sorting::compare_texts(text, other))
            }
            ("repeat", [Value::Int(count)]) => {
                let Ok(count) = usize::try_from(*count) else {
                    return self.throw("IllegalArgumentException", "a count is negative");
                };
                if text.len().saturating_mul(count) > MAX_LETTERS {
                    return self.reject("a string is too long");
                }
                Value::text(text.repeat(count))
            }
            ("formatted", values) => {
                let format = Rc::clone(text);
                return self.formatted(&format, values).map(Some);
            }
            ("isBlank", []) => Value::Boolean(text.trim().is_empty()),
            ("contains", [Value::Text(other)]) => Value::Boolean(text.contains(&**other)),
            ("startsWith", [Value::Text(other)]) => Value::Boolean(text.starts_with(&**other)),
            ("endsWith", [Value::Text(other)]) => Value::Boolean(text.ends_with(&**other)),
            ("concat", [Value::Text(other)]) => Value::text(format!("{text}{other}")),
            ("indexOf" | "lastIndexOf", [pattern]) => {
                let pattern = match pattern {
                    Value::Text(pattern) => pattern.to_string(),
                    Value::Char(code) => String::from_utf16_lossy(&[*code]),
                    _ => return Ok(None),
                };
                let index =
                    if name == "indexOf" { text.find(&pattern) } else { text.rfind(&pattern) };
                index.map_or(Value::Int(-1), |bytes| count(text[..bytes].encode_utf16().count()))
            }
            ("charAt", [index]) => {
                let units = units();
                let index = self.index(index, units.len())?;
                Value::Char(units.get(index).copied().unwrap_or_default())
            }
            ("substring", [begin]) => return self.substring(&units(), begin, None).map(Some),
            ("substring", [begin, end]) => {
                return self.substring(&units(), begin, Some(end)).map(Some);
            }
            ("toCharArray", []) => {
                Value::array("char", text.encode_utf16().map(Value::Char).collect())
            }
            ("replace", [Value::Text(from), Value::Text(to)]) => {
                if from.is_empty() {
                    return Ok(None);
                }
                let replaced = text.replace(&**from, to);
                if replaced.len() > MAX_LETTERS {
                    return self.reject("a string is longer than a million letters");
                }
                Value::text(replaced)
            }
            ("replace", [Value::Char(from), Value::Char(to)]) => {
                let [from, to] = [from, to].map(|code| String::from_utf16_lossy(&[*code]));
                Value::text(text.replace(&from, &to))
            }
            ("split", [Value::Text(by)]) => self.split(text, by),
            _ => return Ok(None),
        }))
    }

    fn substring(
        &mut self,
        units: &[u16],
        begin: &Value,
        end: Option<&Value>,
    ) -> Result<Value, EvaluationStop> {
        let begin = self.index(begin, units.len() + 1)?;
        let end = match end {
            Some(end) => self.index(end, units.len() + 1)?,
            None => units.len(),
        };
        match units.get(begin..end) {
            Some(part) => Ok(Value::text(String::from_utf16_lossy(part))),
            None => self.throw(
                "StringIndexOutOfBoundsException",
                format!("begin {begin}, end {end}, length {}", units.len()),
            ),
        }
    }

    /// Evaluates `split` by a literal text; the result of other regular expressions is unknown.
    fn split(&self, text: &str, by: &str) -> Value {
        let literal = by.strip_prefix('\\').filter(|rest| rest.chars().count() == 1).unwrap_or(by);
        let is_literal = literal.len() < by.len()
            || !by
                .contains(['.', '$', '|', '(', ')', '[', ']', '{', '}', '^', '?', '*', '+', '\\']);
        if !is_literal || literal.is_empty() {
            return self.unknown(format!("a string that is split by the expression {by:?}"));
        }
        let mut parts: Vec<_> = text.split(literal).collect();
        // Trailing empty parts are removed.
        while parts.len() > 1 && parts.last().is_some_and(|part| part.is_empty()) {
            parts.pop();
        }
        Value::array("String", parts.into_iter().map(Value::text).collect())
    }

    /// Calls a method of a builder; `None` if it is not modelled.
    pub(crate) fn of_builder(
        &mut self,
        receiver: &Value,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let Value::Builder(builder) = receiver else { return Ok(None) };
        let text = match &*builder.borrow() {
            Ok(text) => text.clone(),
            Err(unknown) => return Ok(Some(Value::Unknown(Rc::clone(unknown)))),
        };
        if matches!(name, "equals" | "hashCode" | "compareTo") {
            // These methods refer to the object, not to its text.
            return Ok(match (name, arguments) {
                ("equals", [other]) => Some(Value::Boolean(receiver.is_same(other))),
                _ => None,
            });
        }
        if let Some(unknown) = arguments.iter().find_map(Value::unknown)
            && (BUILDING.contains(&name) || name == "append")
        {
            self.spoil(receiver, unknown);
            return Ok(Some(receiver.clone()));
        }
        let mut units: Vec<u16> = text.encode_utf16().collect();
        let length = units.len();
        let mut result = receiver.clone();
        match (name, arguments) {
            ("append", [value]) => {
                let value = match value {
                    Value::Array(array) if array.element.name == "char" => &characters(array),
                    _ => value,
                };
                let added = match self.text_of(value)? {
                    Ok(added) => added,
                    Err(unknown) => {
                        self.spoil(receiver, &unknown);
                        return Ok(Some(result));
                    }
                };
                if text.len() + added.len() > MAX_LETTERS {
                    return self.reject("a string is longer than a million letters");
                }
                self.java.changes += 1;
                if let Ok(text) = &mut *builder.borrow_mut() {
                    text.push_str(&added);
                }
                return Ok(Some(result));
            }
            ("insert", [place, value]) => {
                let place = self.index(place, length + 1)?;
                let added = match self.text_of(value)? {
                    Ok(added) => added,
                    Err(unknown) => {
                        self.spoil(receiver, &unknown);
                        return Ok(Some(result));
                    }
                };
                units.splice(place..place, added.encode_utf16());
            }
            ("reverse", []) => {
                units = text.chars().rev().collect::<String>().encode_utf16().collect();
            }
            ("replace", [begin, end, Value::Text(added)]) => {
                let begin = self.index(begin, length + 1)?;
                let end = self.builder_end(begin, end, length)?;
                units.splice(begin..end, added.encode_utf16());
            }
            ("delete", [begin, end]) => {
                let begin = self.index(begin, length + 1)?;
                let end = self.builder_end(begin, end, length)?;
                units.drain(begin..end);
            }
            ("deleteCharAt", [place]) => {
                let place = self.index(place, length)?;
                units.remove(place);
            }
            ("setCharAt", [place, Value::Char(code)]) => {
                let place = self.index(place, length)?;
                units[place] = *code;
                result = Value::Null;
            }
            ("setLength", [wanted]) => {
                let wanted = self.index(wanted, MAX_LETTERS)?;
                units.resize(wanted, 0);
                result = Value::Null;
            }
            _ => {
                let text = Rc::from(text.as_str());
                return self.of_string(&text, name, arguments);
            }
        }
        if units.len() > MAX_LETTERS {
            return self.reject("a string is longer than a million letters");
        }
        self.java.changes += 1;
        *builder.borrow_mut() = Ok(String::from_utf16_lossy(&units));
        Ok(Some(result))
    }

    /// Returns the end of a builder range, at most the builder's length.
    fn builder_end(
        &mut self,
        begin: usize,
        end: &Value,
        length: usize,
    ) -> Result<usize, EvaluationStop> {
        let end = end.integer().and_then(|end| usize::try_from(end).ok()).unwrap_or(0).min(length);
        if end < begin {
            return self.throw(
                "StringIndexOutOfBoundsException",
                format!("begin {begin}, end {end}, length {length}"),
            );
        }
        Ok(end)
    }
}

/// Methods that change a builder.
const BUILDING: [&str; 6] =
    ["insert", "replace", "delete", "deleteCharAt", "setCharAt", "setLength"];

/// Returns the text of a character array; unknown if a character is unknown.
fn characters(array: &Array) -> Value {
    let mut units = Vec::new();
    for value in array.values.borrow().iter() {
        match value {
            Value::Char(code) => units.push(*code),
            other => return other.clone(),
        }
    }
    Value::text(String::from_utf16_lossy(&units))
}
