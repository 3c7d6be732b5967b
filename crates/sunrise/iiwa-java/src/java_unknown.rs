//! Unmodelled calls of the Java library: the values that they may change are unknown afterwards.

use std::rc::Rc;

use crate::{
    machine::Machine,
    stop::EvaluationStop,
    unknown::Unknown,
    value::{StreamStage, Value, View},
};

/// Library methods that change nothing, but whose results are unknown.
const READING: [&str; 22] = [
    "hashCode",
    "getClass",
    "stream",
    "parallelStream",
    "spliterator",
    "capacity",
    "chars",
    "codePointAt",
    "equals",
    "deepEquals",
    "toString",
    "deepToString",
    "deepHashCode",
    "binarySearch",
    "search",
    "ceilingKey",
    "floorKey",
    "higherKey",
    "lowerKey",
    "containsValue",
    "matches",
    "getSuppressed",
];

/// Methods, of any class, that run their argument.
const RUNNING: [&str; 4] = ["forEach", "forEachOrdered", "ifPresent", "peek"];

impl Machine {
    /// Returns the reason for unknown contents of a collection or a builder.
    pub(crate) fn unknown_contents(value: &Value) -> Option<Rc<Unknown>> {
        match value {
            Value::List(list) => list.unknown(),
            Value::Map(map) => map.borrow().unknown.clone(),
            Value::Builder(text) => text.borrow().as_ref().err().cloned(),
            Value::Iterator(iteration) => iteration.borrow().list.unknown(),
            _ => None,
        }
    }

    /// Marks the contents of a collection, an array or a builder as unknown, and those of its
    /// source if it is a view.
    pub(crate) fn spoil(&mut self, value: &Value, unknown: &Rc<Unknown>) {
        self.java.changes += 1;
        match value {
            Value::List(list) => {
                list.spoil(unknown);
                let view = list.view.borrow().clone();
                match view {
                    Some(View::Array(array)) => self.spoil(&Value::Array(array), unknown),
                    Some(View::Whole(list) | View::Part { list, .. }) => {
                        self.spoil(&Value::List(list), unknown);
                    }
                    Some(View::Map(map, _)) => self.spoil(&Value::Map(map), unknown),
                    None => {}
                }
            }
            Value::Array(array) => {
                array.values.borrow_mut().fill(Value::Unknown(Rc::clone(unknown)));
            }
            Value::Map(map) => {
                let mut map = map.borrow_mut();
                let entry = Value::Unknown(Rc::clone(unknown));
                map.entries = vec![(entry.clone(), entry)];
                map.unknown = Some(Rc::clone(unknown));
            }
            Value::Builder(text) => *text.borrow_mut() = Err(Rc::clone(unknown)),
            Value::Cell(cell) => *cell.borrow_mut() = Value::Unknown(Rc::clone(unknown)),
            Value::Iterator(iteration) => {
                let list = Rc::clone(&iteration.borrow().list);
                self.spoil(&Value::List(list), unknown);
            }
            _ => {}
        }
    }

    /// Returns the result of an unmodelled library method, which may have changed its receiver and
    /// its arguments.
    pub(crate) fn unmodelled(
        &mut self,
        receiver: &Value,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let result = self.unmodelled_result(name, &format!(" of {}", receiver.kind()));
        self.after_unmodelled(Some(receiver), name, arguments, &result)?;
        Ok(result)
    }

    /// Marks the receiver and the arguments of an unmodelled call as unknown.
    pub(crate) fn after_unmodelled(
        &mut self,
        receiver: Option<&Value>,
        name: &str,
        arguments: &[Value],
        result: &Value,
    ) -> Result<(), EvaluationStop> {
        self.check_not_run(name, arguments)?;
        let (false, Value::Unknown(unknown)) = (READING.contains(&name), result) else {
            return Ok(());
        };
        for value in receiver.into_iter().chain(arguments) {
            match value {
                Value::Object(object) => self.may_be_called(object, name, unknown)?,
                Value::Function(_) => self.may_be_run(value, name, unknown)?,
                Value::Stream(stream) => {
                    for function in stream.stages.iter().filter_map(StreamStage::function) {
                        self.may_be_run(function, name, unknown)?;
                    }
                }
                _ => self.spoil(value, unknown),
            }
        }
        Ok(())
    }

    /// Refuses methods that would run code which is not evaluated.
    pub(crate) fn check_not_run(
        &self,
        name: &str,
        arguments: &[Value],
    ) -> Result<(), EvaluationStop> {
        let is_code = |unknown: &&Rc<Unknown>| {
            unknown.reason.contains("lambda expression")
                || unknown.reason.contains("method reference")
        };
        match arguments.iter().filter_map(Value::unknown).find(is_code) {
            Some(code) if RUNNING.contains(&name) => {
                self.reject_unknown(&format!("what `{name}` does"), code)
            }
            _ => Ok(()),
        }
    }

    /// Applies the effects of a function that a library may run at any time, or refuses the call.
    fn may_be_run(
        &mut self,
        function: &Value,
        name: &str,
        unknown: &Rc<Unknown>,
    ) -> Result<(), EvaluationStop> {
        let effects = self.effects_of_function(function, "");
        if RUNNING.contains(&name) || effects.acts() {
            let acts = self.host.acts();
            return self.reject(format!(
                "`{name}` may run {}, in which {}, and is not evaluated",
                function.kind(),
                if effects.acts() { acts } else { "values may change" },
            ));
        }
        self.forget_values(&self.outliving(effects), unknown);
        Ok(())
    }

    /// Applies the effects of an object's methods that a library may call through an interface, or
    /// refuses the call.
    fn may_be_called(
        &mut self,
        object: &Rc<crate::value::JavaObject>,
        name: &str,
        unknown: &Rc<Unknown>,
    ) -> Result<(), EvaluationStop> {
        if let Some(function) = &object.function {
            return self.may_be_run(&Value::Function(Rc::clone(function)), name, unknown);
        }
        let known = self.java.classes.known(object.class);
        let (class, id) = (std::sync::Arc::clone(&known.class), object.class);
        let is_of_library = |type_name: &crate::syntax::TypeName| {
            self.java.classes.find(&type_name.name, id).is_none()
                && !matches!(crate::classes::simple(&type_name.name), "Serializable" | "Cloneable")
        };
        let is_anonymous = class.name.is_empty();
        if !is_anonymous && !class.implements.iter().chain(&class.extends).any(is_of_library) {
            return Ok(());
        }
        for method in &class.methods {
            let Some(body) = &method.body else { continue };
            let effects = self.effects_of(body);
            if effects.acts() {
                let acts = self.host.acts();
                return self.reject(format!(
                    "`{name}` may call `{}`, in which {acts}, and is not evaluated",
                    method.name
                ));
            }
            self.forget_values(&effects, unknown);
        }
        Ok(())
    }
}
