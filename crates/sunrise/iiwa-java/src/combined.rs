//! Functions of the Java library: default and static methods of functional interfaces, and
//! comparators.

use std::rc::Rc;

use crate::{
    interfaces::Interface,
    machine::Machine,
    stop::EvaluationStop,
    value::{Combined, FunctionCode, MapPart, Value},
};

impl Machine {
    /// Calls a default method of a functional interface; `None` if it is not modelled.
    pub(crate) fn combined(
        &mut self,
        this: &Value,
        interface: &Interface,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let interface_name: Rc<str> = Rc::from(interface.name);
        let is_kind = |end: &str| interface.name.ends_with(end);
        if arguments.iter().any(|other| matches!(other, Value::Null)) {
            return self.throw("NullPointerException", format!("`{name}` gets null"));
        }
        let first = this.clone();
        let combined = match (name, arguments) {
            ("andThen", [second]) if is_kind("Consumer") => {
                Combined::Both { first, second: second.clone(), interface: interface_name }
            }
            ("andThen", [second]) if is_kind("Function") || is_kind("Operator") => {
                Combined::Chain { first, interface: interface_name, second: second.clone() }
            }
            ("compose", [before]) if interface.parameters.len() == 1 => {
                Combined::Chain { first: before.clone(), interface: interface_name, second: first }
            }
            ("negate", []) if is_kind("Predicate") => {
                Combined::Not { predicate: first, interface: interface_name }
            }
            ("and", [second]) if is_kind("Predicate") => {
                Combined::And { first, second: second.clone(), interface: interface_name }
            }
            ("or", [second]) if is_kind("Predicate") => {
                Combined::Or { first, second: second.clone(), interface: interface_name }
            }
            _ if interface.name == "Comparator" => {
                return Ok(self.combined_comparator(this, name, arguments));
            }
            _ => return Ok(None),
        };
        Ok(Some(self.library_function(combined)))
    }

    /// Calls a default method of `Comparator`.
    pub(crate) fn combined_comparator(
        &mut self,
        this: &Value,
        name: &str,
        arguments: &[Value],
    ) -> Option<Value> {
        let next = match (name, arguments) {
            ("reversed", []) => {
                return Some(self.library_function(Combined::Reversed(this.clone())));
            }
            ("thenComparing", [next]) if self.is_comparator(next) == Some(true) => next.clone(),
            ("thenComparing", [next]) if self.is_comparator(next).is_none() => return None,
            _ if name.starts_with("thenComparing") => {
                let name = name.replacen("thenC", "c", 1);
                self.of_comparator_class(&name, arguments)?
            }
            _ => return None,
        };
        Some(self.library_function(Combined::Then(this.clone(), next)))
    }

    /// Returns true for a comparator, false for a key extractor; `None` if undecided.
    fn is_comparator(&self, value: &Value) -> Option<bool> {
        match value {
            Value::Object(object) => {
                let has = |name| !self.java.classes.methods(object.class, name).is_empty();
                match (has("compare"), has("apply")) {
                    (true, false) => Some(true),
                    (false, true) => Some(false),
                    _ => None,
                }
            }
            Value::Function(function) => match (&function.code, function.interface.get()) {
                (_, Some(interface)) => Some(interface.name.ends_with("Comparator")),
                (FunctionCode::Lambda(lambda), None) => Some(lambda.parameters.len() == 2),
                _ => None,
            },
            _ => None,
        }
    }

    /// Calls a static method of a functional interface; `None` if it is not modelled.
    pub(crate) fn of_interface_class(
        &mut self,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Option<Value> {
        let combined = match (class, name, arguments) {
            ("Comparator", ..) => return self.of_comparator_class(name, arguments),
            (_, "identity", []) => Combined::Identity,
            ("Predicate", "not", [predicate]) => {
                Combined::Not { predicate: predicate.clone(), interface: Rc::from("Predicate") }
            }
            ("Entry", "comparingByKey" | "comparingByValue", []) => {
                Combined::ByEntry { is_key: name == "comparingByKey" }
            }
            _ => return None,
        };
        Some(self.library_function(combined))
    }

    fn of_comparator_class(&mut self, name: &str, arguments: &[Value]) -> Option<Value> {
        let interface = match name {
            "comparing" => "Function",
            "comparingInt" => "ToIntFunction",
            "comparingLong" => "ToLongFunction",
            "comparingDouble" => "ToDoubleFunction",
            "naturalOrder" => return Some(self.natural_order()),
            "reverseOrder" => return Some(self.reverse_order()),
            _ => return None,
        };
        let interface = Rc::from(interface);
        let combined = match (name, arguments) {
            (_, [key]) => Combined::ByKey { key: key.clone(), interface, order: None },
            ("comparing", [key, order]) => {
                Combined::ByKey { key: key.clone(), interface, order: Some(order.clone()) }
            }
            _ => return None,
        };
        Some(self.library_function(combined))
    }

    pub(crate) fn library_function(&mut self, combined: Combined) -> Value {
        let interface = match &combined {
            Combined::ByKey { .. }
            | Combined::ByEntry { .. }
            | Combined::Reversed(_)
            | Combined::Then(..) => "Comparator",
            Combined::Both { interface, .. }
            | Combined::Not { interface, .. }
            | Combined::And { interface, .. }
            | Combined::Or { interface, .. }
            | Combined::Chain { interface, .. } => interface,
            Combined::Identity => "Function",
        };
        let interface = crate::syntax::TypeName::new(interface, 0);
        let function = self.new_function(self.place.line, FunctionCode::Combined(combined));
        if let Value::Function(function) = &function {
            _ = function.interface.set(interface);
        }
        function
    }

    /// Runs a library function.
    pub(crate) fn run_combined(
        &mut self,
        combined: &Combined,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match (combined, arguments) {
            (Combined::Identity, [value]) => Ok(value.clone()),
            (Combined::Chain { first, interface, second }, _) => {
                let value = self.apply(first, interface, arguments)?;
                // The function after a `BiFunction` takes one value.
                let second_interface = interface.trim_start_matches("Bi");
                let second_interface = match second_interface {
                    "naryOperator" => "Function",
                    other => other,
                };
                self.apply(second, second_interface, &[value])
            }
            (Combined::Both { first, second, interface }, _) => {
                self.apply(first, interface, arguments)?;
                self.apply(second, interface, arguments)
            }
            (Combined::Not { predicate, interface }, _) => {
                Ok(match self.apply(predicate, interface, arguments)? {
                    Value::Boolean(value) => Value::Boolean(!value),
                    other => other,
                })
            }
            (Combined::And { first, second, interface }, _) => {
                match self.apply(first, interface, arguments)? {
                    Value::Boolean(true) => self.apply(second, interface, arguments),
                    other => Ok(other),
                }
            }
            (Combined::Or { first, second, interface }, _) => {
                match self.apply(first, interface, arguments)? {
                    Value::Boolean(false) => self.apply(second, interface, arguments),
                    other => Ok(other),
                }
            }
            (_, [a, b]) => self.compared_by(combined, a, b),
            _ => self.reject("a function of Java's library gets another number of arguments"),
        }
    }

    /// Returns the result of a library comparator.
    fn compared_by(
        &mut self,
        combined: &Combined,
        a: &Value,
        b: &Value,
    ) -> Result<Value, EvaluationStop> {
        let order = match combined {
            Combined::ByKey { key, interface, order } => {
                let first = self.apply(key, interface, std::slice::from_ref(a))?;
                let second = self.apply(key, interface, std::slice::from_ref(b))?;
                for key in [&first, &second] {
                    if matches!(key, Value::Null) && order.is_none() {
                        return self.throw("NullPointerException", "a key is null");
                    }
                }
                return self.comparison(order.as_ref(), &first, &second);
            }
            Combined::ByEntry { is_key } => {
                let part = if *is_key { MapPart::Keys } else { MapPart::Values };
                let [first, second] = [a, b].map(|entry| entry_part(entry, part));
                return self.comparison(None, &first, &second);
            }
            Combined::Reversed(comparator) => return self.comparison(Some(comparator), b, a),
            Combined::Then(first, second) => {
                let order = self.comparison(Some(first), a, b)?;
                if !matches!(order, Value::Int(0)) {
                    return Ok(order);
                }
                self.comparison(Some(second), a, b)?
            }
            _ => return self.reject("a function of Java's library is not a comparator"),
        };
        Ok(order)
    }

    /// Returns the result of a comparator, or of the natural order.
    fn comparison(
        &mut self,
        comparator: Option<&Value>,
        a: &Value,
        b: &Value,
    ) -> Result<Value, EvaluationStop> {
        match comparator {
            Some(comparator) => self.apply(comparator, "Comparator", &[a.clone(), b.clone()]),
            None => self.natural_comparison(a, b),
        }
    }

    /// Evaluates `a.compareTo(b)`.
    fn natural_comparison(&mut self, a: &Value, b: &Value) -> Result<Value, EvaluationStop> {
        match (a, b) {
            (Value::Unknown(_), _) => Ok(a.clone()),
            (_, Value::Unknown(_)) => Ok(b.clone()),
            _ => self.call_on(a, "compareTo", std::slice::from_ref(b)),
        }
    }

    /// Evaluates `Collections.reverseOrder()`.
    pub(crate) fn reverse_order(&mut self) -> Value {
        let natural = self.natural_order();
        self.library_function(Combined::Reversed(natural))
    }

    fn natural_order(&mut self) -> Value {
        let key = self.library_function(Combined::Identity);
        let interface = Rc::from("Function");
        self.library_function(Combined::ByKey { key, interface, order: None })
    }
}

/// Returns the key or the value of a map entry.
fn entry_part(entry: &Value, part: MapPart) -> Value {
    let place = usize::from(part != MapPart::Keys);
    match entry {
        Value::List(list) => list.borrow().get(place).cloned().unwrap_or(Value::Null),
        _ => Value::Null,
    }
}
