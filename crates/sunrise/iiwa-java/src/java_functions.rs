//! Methods of Java collections that run functions, such as `forEach`, `removeIf` and
//! `computeIfAbsent`.

use std::{cell::RefCell, rc::Rc};

use crate::{
    java_lists::CHANGED_MEANWHILE,
    machine::Machine,
    stop::EvaluationStop,
    type_names::is_primitive,
    unknown::Unknown,
    value::{Array, List, Map, Value},
};

impl Machine {
    /// Calls a method that runs a function; `None` if it is not modelled.
    pub(crate) fn run_by_library(
        &mut self,
        receiver: &Value,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let Some(function) = arguments.last() else { return Ok(None) };
        if !matches!(function, Value::Function(_) | Value::Object(_)) {
            return Ok(None);
        }
        match (receiver, name, arguments) {
            (Value::Map(map), "forEach", [_]) if !map.borrow().is_set => {
                self.for_each_entry(receiver, map, function)
            }
            (Value::Map(_) | Value::List(_), "forEach", [_]) => {
                self.for_each_element(receiver, function)
            }
            (Value::List(list), "removeIf", [_]) => {
                let (list, values) = (Rc::clone(list), list.borrow().clone());
                let kept = match self.kept_elements(receiver, values, function)? {
                    Ok(kept) => kept,
                    Err(unknown) => return Ok(Some(Value::Unknown(unknown))),
                };
                let is_changed = kept.len() != list.borrow().len();
                if is_changed {
                    self.replace_elements(&list, kept)?;
                }
                Ok(Some(Value::Boolean(is_changed)))
            }
            (Value::Map(map), "removeIf", [_]) => {
                let Some(values) = Self::iterated(receiver) else { return Ok(None) };
                let kept = match self.kept_elements(receiver, values, function)? {
                    Ok(kept) => kept,
                    Err(unknown) => return Ok(Some(Value::Unknown(unknown))),
                };
                let is_changed = kept.len() != map.borrow().entries.len();
                self.java.changes += u64::from(is_changed);
                map.borrow_mut()
                    .entries
                    .retain(|(key, _)| kept.iter().any(|kept_key| kept_key.is_equal(key)));
                Ok(Some(Value::Boolean(is_changed)))
            }
            (Value::List(list), "replaceAll", [_]) => {
                let list = Rc::clone(list);
                self.replace_all(&list, function)
            }
            (Value::Map(map), _, _) if !map.borrow().is_set => {
                let map = Rc::clone(map);
                self.compute(receiver, &map, name, arguments)
            }
            (Value::Cell(cell), _, _) => {
                let cell = Rc::clone(cell);
                self.update_cell(&cell, name, arguments)
            }
            (Value::Iterator(_), "forEachRemaining", [_]) => {
                while let Value::Boolean(true) = self.call_library(receiver, "hasNext", &[])? {
                    let next = self.call_library(receiver, "next", &[])?;
                    self.apply(function, "Consumer", &[next])?;
                }
                Ok(Some(Value::Null))
            }
            _ => Ok(None),
        }
    }

    fn for_each_element(
        &mut self,
        receiver: &Value,
        function: &Value,
    ) -> Result<Option<Value>, EvaluationStop> {
        let Some(values) = Self::iterated(receiver) else { return Ok(None) };
        let begin = Self::structure(receiver);
        for (place, value) in values.into_iter().enumerate() {
            let value = Self::current(receiver, place).unwrap_or(value);
            self.apply(function, "Consumer", &[value])?;
            self.refresh(receiver);
            if Self::structure(receiver) != begin {
                return self.reject(CHANGED_MEANWHILE);
            }
        }
        Ok(Some(Value::Null))
    }

    fn for_each_entry(
        &mut self,
        receiver: &Value,
        map: &Rc<RefCell<Map>>,
        function: &Value,
    ) -> Result<Option<Value>, EvaluationStop> {
        let Some(entries) = Self::ordered_entries(map) else { return Ok(None) };
        let begin = Self::structure(receiver);
        for (key, value) in entries {
            self.apply(function, "BiConsumer", &[key, value])?;
            if Self::structure(receiver) != begin {
                return self.reject(CHANGED_MEANWHILE);
            }
        }
        Ok(Some(Value::Null))
    }

    /// Returns the elements for which a predicate is false; unknown if a result of the predicate is
    /// unknown.
    fn kept_elements(
        &mut self,
        receiver: &Value,
        values: Vec<Value>,
        predicate: &Value,
    ) -> Result<Result<Vec<Value>, Rc<Unknown>>, EvaluationStop> {
        let begin = Self::structure(receiver);
        let mut kept = Vec::new();
        for value in values {
            match self.apply(predicate, "Predicate", std::slice::from_ref(&value))? {
                Value::Boolean(true) => {}
                Value::Boolean(false) => kept.push(value),
                Value::Unknown(unknown) => {
                    self.spoil(receiver, &unknown);
                    return Ok(Err(unknown));
                }
                other => return self.reject(format!("the result of a test is {}", other.kind())),
            }
            if Self::structure(receiver) != begin {
                return self.reject(CHANGED_MEANWHILE);
            }
        }
        Ok(Ok(kept))
    }

    fn replace_all(
        &mut self,
        list: &Rc<List>,
        function: &Value,
    ) -> Result<Option<Value>, EvaluationStop> {
        let receiver = Value::List(Rc::clone(list));
        let begin = Self::structure(&receiver);
        let length = list.borrow().len();
        for place in 0..length {
            let value = list.borrow().get(place).cloned().unwrap_or(Value::Null);
            let value = self.apply(function, "UnaryOperator", &[value])?;
            if Self::structure(&receiver) != begin {
                return self.reject(CHANGED_MEANWHILE);
            }
            let place = Value::Int(i32::try_from(place).unwrap_or(i32::MAX));
            self.call_library(&receiver, "set", &[place, value])?;
        }
        Ok(Some(Value::Null))
    }

    /// Evaluates `computeIfAbsent`, `computeIfPresent`, `compute`, `merge` or `replaceAll` of a
    /// map.
    fn compute(
        &mut self,
        receiver: &Value,
        map: &Rc<RefCell<Map>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        if let ("replaceAll", [function]) = (name, arguments) {
            let Some(entries) = Self::ordered_entries(map) else { return Ok(None) };
            for (key, value) in entries {
                let value = self.apply(function, "BiFunction", &[key.clone(), value])?;
                self.of_map(receiver, map, "put", &[key, value])?;
            }
            return Ok(Some(Value::Null));
        }
        let (Some(key), Some(function)) = (arguments.first(), arguments.last()) else {
            return Ok(None);
        };
        let old = match self.key_place(map, key)? {
            Ok(Some(place)) => map.borrow().entries[place].1.clone(),
            Ok(None) => Value::Null,
            Err(unknown) => {
                self.spoil(receiver, &unknown);
                return Ok(None);
            }
        };
        let is_absent = matches!(old, Value::Null);
        let begin = Self::structure(receiver);
        let new = match (name, arguments) {
            ("computeIfAbsent", [_, _]) if is_absent => {
                self.apply(function, "Function", std::slice::from_ref(key))?
            }
            ("computeIfAbsent", [_, _]) => return Ok(Some(old)),
            ("computeIfPresent", [_, _]) if is_absent => return Ok(Some(Value::Null)),
            ("computeIfPresent" | "compute", [_, _]) => {
                self.apply(function, "BiFunction", &[key.clone(), old.clone()])?
            }
            ("merge", [_, Value::Null, _]) => {
                return self.throw("NullPointerException", "a value is null");
            }
            ("merge", [_, value, _]) if is_absent => value.clone(),
            ("merge", [_, value, _]) => {
                self.apply(function, "BiFunction", &[old.clone(), value.clone()])?
            }
            _ => return Ok(None),
        };
        if Self::structure(receiver) != begin {
            return self.reject(CHANGED_MEANWHILE);
        }
        match &new {
            // The value may be null, which would remove the entry.
            Value::Unknown(unknown) => self.spoil(receiver, unknown),
            Value::Null if name == "computeIfAbsent" => {}
            Value::Null => _ = self.of_map(receiver, map, "remove", std::slice::from_ref(key))?,
            new => _ = self.of_map(receiver, map, "put", &[key.clone(), new.clone()])?,
        }
        Ok(Some(new))
    }

    /// Evaluates `updateAndGet` and similar methods of `AtomicInteger`.
    fn update_cell(
        &mut self,
        cell: &Rc<RefCell<Value>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let old = cell.borrow().clone();
        let kind = match old {
            Value::Int(_) => "Int",
            Value::Long(_) => "Long",
            _ => "",
        };
        let is_object = kind.is_empty();
        let interface = match (arguments.len(), is_object) {
            (1, true) => "UnaryOperator".to_owned(),
            (1, false) => format!("{kind}UnaryOperator"),
            (_, true) => "BinaryOperator".to_owned(),
            (_, false) => format!("{kind}BinaryOperator"),
        };
        let new = match (name, arguments) {
            ("updateAndGet" | "getAndUpdate", [function]) => {
                self.apply(function, &interface, std::slice::from_ref(&old))?
            }
            ("accumulateAndGet" | "getAndAccumulate", [value, function]) => {
                self.apply(function, &interface, &[old.clone(), value.clone()])?
            }
            _ => return Ok(None),
        };
        self.java.changes += u64::from(!old.is_same(&new));
        *cell.borrow_mut() = new.clone();
        Ok(Some(if name.starts_with("get") { old } else { new }))
    }

    /// Evaluates `Arrays.setAll`.
    pub(crate) fn set_all(
        &mut self,
        array: &Rc<Array>,
        function: &Value,
    ) -> Result<Value, EvaluationStop> {
        let interface = match array.element.name.as_str() {
            "int" => "IntUnaryOperator",
            "long" => "IntToLongFunction",
            "double" => "IntToDoubleFunction",
            _ if is_primitive(&array.element) => {
                return self.reject("an array of this type cannot be set by a function");
            }
            _ => "IntFunction",
        };
        let length = array.values.borrow().len();
        for place in 0..length {
            let index = Value::Int(i32::try_from(place).unwrap_or(i32::MAX));
            let value = self.apply(function, interface, &[index])?;
            let value = self.for_variable(value, &array.element)?;
            if let Some(element) = array.values.borrow_mut().get_mut(place) {
                *element = value;
            }
        }
        self.java.changes += 1;
        Ok(Value::Null)
    }
}
