//! `instanceof` and patterns (JLS 14.30, 15.20.2).

use crate::{
    class_id::ClassId,
    classes::simple,
    library_calls::class_of_value,
    machine::Machine,
    stop::EvaluationStop,
    syntax::{ClassKind, Pattern, TypeName},
    type_names::{boxed_names, is_primitive},
    value::{ListKind, Value},
    variables::fields,
};

/// Interfaces that all lists implement.
const OF_LISTS: [&str; 4] = ["List", "Collection", "Iterable", "Object"];

impl Machine {
    /// Matches a value with a pattern: a boolean or unknown. The variables are declared if the
    /// value may match.
    pub(crate) fn matches(
        &mut self,
        value: &Value,
        pattern: &Pattern,
    ) -> Result<Value, EvaluationStop> {
        let (type_name, result) = match pattern {
            Pattern::Any => return Ok(Value::Boolean(true)),
            Pattern::Type { type_name, .. } | Pattern::Record { type_name, .. } => {
                (type_name, self.is_instance(value, type_name))
            }
        };
        match pattern {
            _ if matches!(result, Value::Boolean(false)) => Ok(result),
            Pattern::Record { parts, .. } => self.matches_record(value, type_name, parts, result),
            Pattern::Type { name: Some(name), .. } => {
                self.declare_matched(name, type_name, value, &result);
                Ok(result)
            }
            _ => Ok(result),
        }
    }

    fn declare_matched(&mut self, name: &str, type_name: &TypeName, value: &Value, result: &Value) {
        let value = if matches!(result, Value::Unknown(_)) { result } else { value };
        self.java.declare(name, Some(type_name), value.clone());
    }

    fn matches_record(
        &mut self,
        value: &Value,
        type_name: &TypeName,
        parts: &[Pattern],
        result: Value,
    ) -> Result<Value, EvaluationStop> {
        let Value::Object(object) = value else {
            return Ok(match result {
                Value::Unknown(_) => result,
                _ => self.unknown(format!("the parts of a `{}`", type_name.name)),
            });
        };
        let class = std::sync::Arc::clone(&self.java.classes.known(object.class).class);
        if class.kind != ClassKind::Record {
            return self.reject(format!("a pattern has the parts of {}, no record", class.name));
        }
        let components = fields(&class.members).filter(|field| !field.is_static);
        let components: Vec<_> = components.take(parts.len()).collect();
        for (component, part) in components.into_iter().zip(parts) {
            let value = self.call_on_object(object, &component.name, &[])?;
            let result = match part {
                Pattern::Type { type_name, name }
                    if self.is_total(&component.type_name, type_name) =>
                {
                    if let Some(name) = name {
                        self.java.declare(name, Some(&component.type_name), value);
                    }
                    continue;
                }
                other => self.matches(&value, other)?,
            };
            if !matches!(result, Value::Boolean(true)) {
                return Ok(result);
            }
        }
        Ok(Value::Boolean(true))
    }

    /// Returns true if a pattern of this type matches all values of a component, including null.
    fn is_total(&self, component: &TypeName, wanted: &TypeName) -> bool {
        wanted.name == "var" || self.widens(component, wanted, false) == Some(true)
    }

    /// Tests a value's type: a boolean, or unknown.
    pub(crate) fn is_instance(&mut self, value: &Value, type_name: &TypeName) -> Value {
        let simple = simple(&type_name.name);
        let not_known = || format!("whether {} is a {simple}", value.kind());
        match value {
            Value::Unknown(_) => value.clone(),
            Value::Null => Value::Boolean(false),
            _ if type_name.dimensions > 0 => match value {
                Value::Array(array) => self.is_array_of(&array.element, type_name),
                _ => Value::Boolean(false),
            },
            Value::Object(object) => {
                let class =
                    self.java.activation().map_or(object.class, |activation| activation.class);
                let is_it = match self.java.classes.find(&type_name.name, class) {
                    Some(id) => self.java.classes.is_a(object.class, id),
                    None => {
                        simple == "Object"
                            || self.java.classes.foreign_parent(object.class) == Some(simple)
                            || self.implements_foreign(object.class, simple)
                    }
                };
                Value::Boolean(is_it)
            }
            Value::Function(function) => match function.interface.get() {
                Some(interface) if crate::classes::simple(&interface.name) == simple => {
                    Value::Boolean(true)
                }
                _ if simple == "Object" => Value::Boolean(true),
                _ => self.unknown(not_known()),
            },
            _ if self.is_of_project(type_name) => Value::Boolean(false),
            Value::Int(_) if matches!(simple, "Short" | "Byte") => {
                self.unknown(format!("whether a number is a {simple}"))
            }
            _ if class_of_value(value).is_some() => {
                let class = class_of_value(value).unwrap_or_default();
                match self.widens(&TypeName::new(class, 0), type_name, false) {
                    Some(is_it) => Value::Boolean(is_it),
                    None => self.unknown(not_known()),
                }
            }
            Value::List(_) | Value::Map(_) | Value::Builder(_) | Value::Array(_)
                if simple == "String"
                    || simple == "Number"
                    || boxed_names().any(|boxed_name| boxed_name == simple) =>
            {
                Value::Boolean(false)
            }
            // Map entries are represented as lists of two elements, and map views as collections.
            Value::List(list)
                if OF_LISTS.contains(&simple)
                    && (list.kind == ListKind::Immutable
                        || list.borrow().len() != 2 && list.view.borrow().is_none()) =>
            {
                match list.kind {
                    ListKind::Deque if simple == "List" => self.unknown(not_known()),
                    _ => Value::Boolean(true),
                }
            }
            Value::Map(map) if matches!(simple, "Map" | "Set") => {
                Value::Boolean(map.borrow().is_set == (simple == "Set"))
            }
            _ if simple == "Object" => Value::Boolean(true),
            _ => self.unknown(not_known()),
        }
    }

    /// Returns true if a class or a superclass implements an interface of this name outside the
    /// project.
    fn implements_foreign(&self, id: ClassId, name: &str) -> bool {
        let classes = &self.java.classes;
        let mut above = classes.with_parents(id).into_iter();
        above.any(|id| {
            classes
                .known(id)
                .class
                .implements
                .iter()
                .any(|interface| simple(&interface.name) == name)
        })
    }

    fn is_array_of(&self, element: &TypeName, wanted: &TypeName) -> Value {
        let wanted = wanted.element();
        match self.widens(element, &wanted, false) {
            _ if is_primitive(element) || is_primitive(&wanted) => {
                Value::Boolean(*element == wanted)
            }
            Some(is_it) => Value::Boolean(is_it),
            None => self.unknown("the type of an array"),
        }
    }
}
