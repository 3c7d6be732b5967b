//! Calls on Java library values: common rules.

use std::rc::Rc;

use crate::{
    machine::Machine,
    stop::EvaluationStop,
    syntax::TypeName,
    type_names::{is_primitive, unboxed},
    value::{Thrown, Value},
};

impl Machine {
    /// Calls a method of a Java library value.
    pub(crate) fn call_library(
        &mut self,
        receiver: &Value,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let result = self.library_method(receiver, name, arguments);
        Self::with_class_of_index(receiver, result)
    }

    /// Sets the exception class of an invalid index, which differs between arrays, lists and
    /// strings.
    fn with_class_of_index(
        receiver: &Value,
        result: Result<Value, EvaluationStop>,
    ) -> Result<Value, EvaluationStop> {
        let class = match receiver {
            Value::List(list) if list.is_fixed_size() => return result,
            Value::Text(_) | Value::Builder(_) => "StringIndexOutOfBoundsException",
            Value::List(_) => "IndexOutOfBoundsException",
            _ => return result,
        };
        match result {
            Err(EvaluationStop::Thrown(thrown))
                if thrown
                    .classes
                    .iter()
                    .any(|class| &**class == "ArrayIndexOutOfBoundsException") =>
            {
                Err(EvaluationStop::Thrown(Rc::new(Thrown {
                    classes: vec![Rc::from(class)],
                    value: thrown.value.clone(),
                    message: thrown.message.clone(),
                    place: thrown.place.clone(),
                })))
            }
            other => other,
        }
    }

    /// Casts a value to a type.
    pub(crate) fn cast(
        &mut self,
        value: Value,
        from: Option<&TypeName>,
        wanted: &TypeName,
    ) -> Result<Value, EvaluationStop> {
        if wanted.dimensions > 0 || matches!(value, Value::Unknown(_)) {
            return Ok(value);
        }
        if matches!(value, Value::Function(_)) {
            return self.for_variable(value, wanted);
        }
        if is_primitive(wanted) {
            if matches!(value, Value::Null) {
                return self.throw("NullPointerException", format!("null is no `{}`", wanted.name));
            }
            // An object is cast only to its own class, and then converted.
            let is_object = from.is_some_and(|type_name| {
                matches!(
                    crate::classes::simple(&type_name.name),
                    "Object" | "Number" | "Comparable"
                )
            });
            let value_type = class_of_value(&value).map(|class| TypeName::new(class, 0));
            if let (true, Some(value_type)) = (is_object, value_type)
                && unboxed(&value_type) != Some(wanted.name.as_str())
                && !(value_type.name == "Integer"
                    && matches!(wanted.name.as_str(), "byte" | "short"))
            {
                return self.not_of_class(&value, wanted);
            }
            return Ok(value.cast_to(wanted));
        }
        let is_known = class_of_value(&value).is_some()
            || matches!(&value, Value::Object(_) if self.is_of_project(wanted));
        if is_known && matches!(self.is_instance(&value, wanted), Value::Boolean(false)) {
            return self.not_of_class(&value, wanted);
        }
        Ok(value.cast_to(wanted))
    }

    pub(crate) fn is_of_project(&self, wanted: &TypeName) -> bool {
        let within = self.java.activation().map(|activation| activation.class);
        within.is_some_and(|class| self.java.classes.find(&wanted.name, class).is_some())
    }

    fn not_of_class<T>(&self, value: &Value, wanted: &TypeName) -> Result<T, EvaluationStop> {
        self.throw("ClassCastException", format!("{} is no `{}`", value.kind(), wanted.name))
    }
}

/// Returns the class of a value as an object; `Integer` for integers that may be a `byte` or a
/// `short`.
pub(crate) fn class_of_value(value: &Value) -> Option<&'static str> {
    Some(match value {
        Value::Text(_) => "String",
        Value::Boolean(_) => "Boolean",
        Value::Char(_) => "Character",
        Value::Int(_) => "Integer",
        Value::Long(_) => "Long",
        Value::Float(_) => "Float",
        Value::Double(_) => "Double",
        _ => return None,
    })
}
