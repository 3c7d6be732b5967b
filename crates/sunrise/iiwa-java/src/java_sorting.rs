//! Order and equality of values in Java collections.

use std::{cmp::Ordering, rc::Rc};

use crate::{
    effects::Effects,
    expressions::may_be_same,
    machine::Machine,
    stop::EvaluationStop,
    syntax::ClassKind,
    unknown::Unknown,
    value::{JavaObject, Value},
    variables::fields,
};

/// Result, or the unknown value that it depends on.
pub(crate) type Known<T> = Result<T, Rc<Unknown>>;

/// Evaluates `String.compareTo`.
pub(crate) fn compare_texts(a: &str, b: &str) -> i32 {
    let [first, second] = [a, b].map(|text| text.encode_utf16().collect::<Vec<_>>());
    let differs = first.iter().zip(&second).find(|(a, b)| a != b);
    match differs {
        Some((a, b)) => i32::from(*a) - i32::from(*b),
        None => {
            i32::try_from(first.len()).unwrap_or(i32::MAX)
                - i32::try_from(second.len()).unwrap_or(i32::MAX)
        }
    }
}

fn ordinal(object: &JavaObject) -> Option<i32> {
    object.constant.as_ref().map(|(_, ordinal)| *ordinal)
}

/// Returns the natural order of numbers, strings and enum constants; `None` for other values.
pub(crate) fn natural(a: &Value, b: &Value) -> Option<Ordering> {
    match (a, b) {
        (Value::Text(a), Value::Text(b)) => Some(compare_texts(a, b).cmp(&0)),
        (Value::Boolean(a), Value::Boolean(b)) => Some(a.cmp(b)),
        (Value::Object(a), Value::Object(b)) => Some(ordinal(a)?.cmp(&ordinal(b)?)),
        _ => match (a.integer(), b.integer()) {
            (Some(a), Some(b)) => Some(a.cmp(&b)),
            _ => Some(a.number()?.total_cmp(&b.number()?)),
        },
    }
}

impl Machine {
    /// Compares two elements by a comparator or by their natural order.
    fn order_of_elements(
        &mut self,
        comparator: Option<&Value>,
        a: &Value,
        b: &Value,
    ) -> Result<Known<Ordering>, EvaluationStop> {
        for value in [a, b] {
            if let Value::Unknown(unknown) = value {
                return Ok(Err(Rc::clone(unknown)));
            }
        }
        let order = match comparator {
            None | Some(Value::Null) => {
                if let Some(order) = natural(a, b) {
                    return Ok(Ok(order));
                }
                match a {
                    Value::Object(object) => {
                        self.call_on_object(object, "compareTo", std::slice::from_ref(b))?
                    }
                    _ => self.unknown(format!("the order of {}", a.kind())),
                }
            }
            Some(function @ (Value::Function(_) | Value::Object(_))) => {
                self.apply(function, "Comparator", &[a.clone(), b.clone()])?
            }
            Some(Value::Unknown(unknown)) => Value::Unknown(Rc::clone(unknown)),
            Some(other) => self.unknown(format!("the order of {}", other.kind())),
        };
        Ok(match order {
            Value::Int(order) => Ok(order.cmp(&0)),
            Value::Unknown(unknown) => Err(unknown),
            other => return self.reject(format!("the result of a comparison is {}", other.kind())),
        })
    }

    /// Sorts elements stably, as Java does. The order of comparisons is unspecified.
    pub(crate) fn sorted(
        &mut self,
        values: Vec<Value>,
        comparator: Option<&Value>,
    ) -> Result<Known<Vec<Value>>, EvaluationStop> {
        let comparator = comparator.filter(|comparator| !matches!(comparator, Value::Null));
        let effects = match comparator {
            Some(comparator) => self.effects_of_function(comparator, "compare"),
            None if matches!(values.first(), Some(Value::Object(_))) => {
                self.effects_of_method("compareTo")
            }
            None => Effects::default(),
        };
        if effects.acts() && values.len() > 1 {
            let acts = self.host.acts();
            return self.reject(format!("the order of comparisons, in which {acts}, is not known"));
        }
        let sorted = self.merge_sorted(values, comparator)?;
        if let Value::Unknown(unknown) = self.unknown("the number and order of comparisons") {
            self.forget_values(&self.outliving(effects), &unknown);
        }
        Ok(sorted)
    }

    /// Returns the maximum or minimum of elements, the first of equal ones; `None` without
    /// elements.
    pub(crate) fn extreme(
        &mut self,
        values: Vec<Value>,
        comparator: Option<&Value>,
        is_max: bool,
        is_candidate_first: bool,
    ) -> Result<Known<Option<Value>>, EvaluationStop> {
        let wanted = if is_max == is_candidate_first { Ordering::Less } else { Ordering::Greater };
        let mut values = values.into_iter();
        let Some(mut candidate) = values.next() else { return Ok(Ok(None)) };
        if let Value::Unknown(unknown) = &candidate {
            return Ok(Err(Rc::clone(unknown)));
        }
        for next in values {
            let (a, b) = if is_candidate_first { (&candidate, &next) } else { (&next, &candidate) };
            match self.order_of_elements(comparator, a, b)? {
                Ok(order) if order == wanted => candidate = next,
                Ok(_) => {}
                Err(unknown) => return Ok(Err(unknown)),
            }
        }
        Ok(Ok(Some(candidate)))
    }

    fn merge_sorted(
        &mut self,
        mut values: Vec<Value>,
        comparator: Option<&Value>,
    ) -> Result<Known<Vec<Value>>, EvaluationStop> {
        if values.len() < 2 {
            return Ok(Ok(values));
        }
        let second = values.split_off(values.len() / 2);
        let (first, second) =
            (self.merge_sorted(values, comparator)?, self.merge_sorted(second, comparator)?);
        let (Ok(first), Ok(second)) = (&first, &second) else {
            return Ok(first.and(second));
        };
        let mut merged = Vec::with_capacity(first.len() + second.len());
        let (mut first, mut second) = (first.iter().peekable(), second.iter().peekable());
        while let (Some(a), Some(b)) = (first.peek(), second.peek()) {
            let order = match self.order_of_elements(comparator, a, b)? {
                Ok(order) => order,
                Err(unknown) => return Ok(Err(unknown)),
            };
            let next = if order == Ordering::Greater { second.next() } else { first.next() };
            merged.extend(next.cloned());
        }
        merged.extend(first.chain(second).cloned());
        Ok(Ok(merged))
    }

    /// Evaluates `a.equals(b)` for elements.
    pub(crate) fn are_equal(
        &mut self,
        a: &Value,
        b: &Value,
    ) -> Result<Known<bool>, EvaluationStop> {
        for value in [a, b] {
            if let Some(unknown) =
                value.unknown().cloned().or_else(|| Self::unknown_contents(value))
            {
                return Ok(Err(unknown));
            }
        }
        let result = match (a, b) {
            _ if !a.is_same(b) && may_be_same(a, b) => {
                self.unknown("whether two lambda expressions of a place are the same object")
            }
            (Value::Object(object), _)
                if !self.java.classes.methods(object.class, "equals").is_empty() =>
            {
                self.call_on_object(object, "equals", std::slice::from_ref(b))?
            }
            (Value::Object(_), Value::Object(_)) => return self.are_equal_records(a, b),
            (Value::Optional(first), Value::Optional(second)) => {
                return match (&**first, &**second) {
                    (Some(a), Some(b)) => self.are_equal(a, b),
                    (a, b) => Ok(Ok(a.is_none() == b.is_none())),
                };
            }
            (Value::Host(_), _) if !a.is_same(b) => {
                self.call_on(a, "equals", std::slice::from_ref(b))?
            }
            (Value::List(first), Value::List(second)) if !a.is_same(b) => {
                let [first, second] = [first, second].map(|list| list.borrow().clone());
                if first.len() != second.len() {
                    return Ok(Ok(false));
                }
                for (a, b) in first.iter().zip(&second) {
                    match self.are_equal(a, b)? {
                        Ok(true) => {}
                        other => return Ok(other),
                    }
                }
                Value::Boolean(true)
            }
            (Value::Map(_), Value::Map(_)) if !a.is_same(b) => {
                self.unknown("whether two maps or sets are equal")
            }
            // Boxed numbers of different types differ.
            _ => Value::Boolean(a.is_equal(b)),
        };
        Ok(match result {
            Value::Boolean(is_equal) => Ok(is_equal),
            Value::Unknown(unknown) => Err(unknown),
            other => return self.reject(format!("the result of `equals` is {}", other.kind())),
        })
    }

    /// Compares objects without a project `equals`: records by their components, others by
    /// identity.
    pub(crate) fn are_equal_records(
        &mut self,
        a: &Value,
        b: &Value,
    ) -> Result<Known<bool>, EvaluationStop> {
        let (Value::Object(first), Value::Object(second)) = (a, b) else { return Ok(Ok(false)) };
        let class = std::sync::Arc::clone(&self.java.classes.known(first.class).class);
        if a.is_same(b) || first.class != second.class || class.kind != ClassKind::Record {
            return Ok(Ok(a.is_same(b)));
        }
        let components = fields(&class.members).filter(|field| !field.is_static);
        for key in components.map(|component| (first.class, component.name.clone())) {
            let [component, other] = [first, second]
                .map(|record| record.fields.borrow().get(&key).cloned().unwrap_or(Value::Null));
            match self.are_equal(&component, &other)? {
                Ok(true) => {}
                other => return Ok(other),
            }
        }
        Ok(Ok(true))
    }

    /// Returns the index of the first element that equals a value.
    pub(crate) fn place_of(
        &mut self,
        values: &[Value],
        value: &Value,
    ) -> Result<Known<Option<usize>>, EvaluationStop> {
        for (place, other) in values.iter().enumerate() {
            match self.are_equal(value, other)? {
                Ok(true) => return Ok(Ok(Some(place))),
                Ok(false) => {}
                Err(unknown) => return Ok(Err(unknown)),
            }
        }
        Ok(Ok(None))
    }
}
