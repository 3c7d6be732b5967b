//! `Collectors` and `Optional` of the Java library.

use std::{cell::RefCell, rc::Rc};

use crate::{
    machine::Machine,
    stop::EvaluationStop,
    value::{Collector, Map, Value},
};

impl Machine {
    /// Evaluates `Collectors.name(...)`; `None` if it is not modelled.
    pub(crate) fn of_collectors(name: &str, arguments: &[Value]) -> Option<Value> {
        let text = |value: Option<&Value>| match value {
            None => Some(Rc::from("")),
            Some(Value::Text(text)) => Some(Rc::clone(text)),
            Some(_) => None,
        };
        let collector = match (name, arguments) {
            ("toList" | "toUnmodifiableList", []) => Collector::List,
            ("toSet", []) => Collector::Set,
            ("counting", []) => Collector::Counting,
            ("joining", parts) => {
                Collector::Joining([text(parts.first())?, text(parts.get(1))?, text(parts.get(2))?])
            }
            ("toMap", [key, value]) => Collector::Map(key.clone(), value.clone()),
            ("groupingBy", [key]) => Collector::Grouping(key.clone()),
            _ => return None,
        };
        Some(Value::Collector(Rc::new(collector)))
    }

    /// Collects the elements of a stream.
    pub(crate) fn collected(
        &mut self,
        values: Vec<Value>,
        collector: &Collector,
    ) -> Result<Value, EvaluationStop> {
        let new_map = |is_set| Value::Map(Rc::new(RefCell::new(Map { is_set, ..Map::default() })));
        match collector {
            Collector::List => Ok(Value::list(values)),
            Collector::Counting => Ok(Value::Long(i64::try_from(values.len()).unwrap_or(i64::MAX))),
            Collector::Set => {
                let set = new_map(true);
                self.call_library(&set, "addAll", &[Value::list(values)])?;
                Ok(set)
            }
            Collector::Joining([between, before, behind]) => {
                let mut texts = Vec::new();
                for value in &values {
                    match self.text_of(value)? {
                        Ok(text) => texts.push(text),
                        Err(unknown) => return Ok(Value::Unknown(unknown)),
                    }
                }
                Ok(Value::text(format!("{before}{}{behind}", texts.join(between))))
            }
            Collector::Map(key, mapper) => {
                let map = new_map(false);
                for value in values {
                    let key = self.apply(key, "Function", std::slice::from_ref(&value))?;
                    let value = self.apply(mapper, "Function", &[value])?;
                    if matches!(value, Value::Null) {
                        return self.throw("NullPointerException", "a value of a map is null");
                    }
                    let old = self.call_library(&map, "put", &[key, value])?;
                    if !matches!(old, Value::Null | Value::Unknown(_)) {
                        return self.throw("IllegalStateException", "a key of a map is doubled");
                    }
                }
                Ok(map)
            }
            Collector::Grouping(key) => {
                let map = new_map(false);
                for value in values {
                    let key = self.apply(key, "Function", std::slice::from_ref(&value))?;
                    let empty = Value::list(Vec::new());
                    let old = self.call_library(&map, "putIfAbsent", &[key, empty.clone()])?;
                    let group = if matches!(old, Value::Null) { empty } else { old };
                    self.call_on(&group, "add", &[value])?;
                }
                Ok(map)
            }
        }
    }

    /// Evaluates `Optional.name(...)`; `None` if it is not modelled.
    pub(crate) fn of_optional_class(
        &mut self,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let value = match (name, arguments) {
            ("empty", []) | ("ofNullable", [Value::Null]) => None,
            (_, [unknown @ Value::Unknown(_)]) => return Ok(Some(unknown.clone())),
            ("of", [Value::Null]) => {
                return self.throw("NullPointerException", "an optional value is null");
            }
            ("of" | "ofNullable", [value]) => Some(value.clone()),
            _ => return Ok(None),
        };
        Ok(Some(Value::Optional(Rc::new(value))))
    }

    /// Calls a method of an optional value; `None` if it is not modelled.
    pub(crate) fn of_optional(
        &mut self,
        optional: &Rc<Option<Value>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let value = (**optional).clone();
        let same = || Value::Optional(Rc::clone(optional));
        let empty = || Value::Optional(Rc::new(None));
        Ok(Some(match (name, arguments, value) {
            ("isPresent", [], value) => Value::Boolean(value.is_some()),
            ("isEmpty", [], value) => Value::Boolean(value.is_none()),
            ("get" | "getAsInt" | "getAsLong" | "getAsDouble" | "orElseThrow", [], value) => {
                match value {
                    Some(value) => value,
                    None => return self.throw("NoSuchElementException", "No value present"),
                }
            }
            ("orElse", [other], value) => value.unwrap_or_else(|| other.clone()),
            ("orElseGet", [_], Some(value)) => value,
            ("orElseGet", [f], None) => self.apply(f, "Supplier", &[])?,
            ("ifPresent", [f], Some(value)) => self.apply(f, "Consumer", &[value])?,
            ("ifPresent", [_], None) => Value::Null,
            ("map" | "flatMap" | "filter", [_], None) => empty(),
            ("map", [f], Some(value)) => match self.apply(f, "Function", &[value])? {
                Value::Null => empty(),
                value @ Value::Unknown(_) => value,
                value => Value::Optional(Rc::new(Some(value))),
            },
            ("flatMap", [f], Some(value)) => self.apply(f, "Function", &[value])?,
            ("filter", [f], Some(value)) => match self.apply(f, "Predicate", &[value])? {
                Value::Boolean(true) => same(),
                Value::Boolean(false) => empty(),
                other => other,
            },
            _ => return Ok(None),
        }))
    }
}
