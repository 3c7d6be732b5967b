//! Inputs and outputs.

use crate::{AnswerValue, QuestionKind};
use iiwa_java::{EvaluationStop, Value};

use crate::application::{asked::Asked, robotics::Robotics, signals::signal};

impl Robotics<'_> {
    /// Calls a method of an I/O group.
    pub(crate) fn call_io_group(
        &mut self,
        group: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match (name, arguments) {
            (
                "addInput"
                | "addDigitalOutput"
                | "addOutput"
                | "addMockedInput"
                | "addMockedDigitalOutput"
                | "addAnalogOutput",
                _,
            ) => Ok(Value::Null),
            ("getInput" | "getOutput" | "getIO", [Value::Text(name)]) => Ok(signal(group, name)),
            (_, [Value::Text(signal), rest @ ..]) if name.starts_with("get") => {
                let is_output = matches!(rest.first(), Some(Value::Boolean(true)));
                let value = self.read_signal(group, signal, is_output, name.contains("Boolean"))?;
                Ok(match value.number() {
                    Some(number) if name.contains("Analog") => Value::Double(number),
                    _ => value,
                })
            }
            (_, [Value::Text(signal), value]) if name.starts_with("set") => {
                self.set_output(group, signal, value)
            }
            // Methods `getName()` and `setName(value)` of a group whose class is not in the
            // project.
            (_, []) if name.starts_with("get") || name.starts_with("is") => {
                let signal = name.strip_prefix("get").or(name.strip_prefix("is")).unwrap_or(name);
                self.read_signal(group, signal, false, false)
            }
            (_, [value]) if name.starts_with("set") => {
                let signal = name.strip_prefix("set").unwrap_or(name);
                self.set_output(group, signal, value)
            }
            _ => Ok(self.not_known(&format!("AbstractIOGroup.{name}"))),
        }
    }

    /// Reads a signal: the value that the program has set, or the given value.
    fn read_signal(
        &mut self,
        group: &str,
        signal: &str,
        is_output: bool,
        is_boolean: bool,
    ) -> Result<Value, EvaluationStop> {
        let id = format!("{group}.{signal}");
        self.station.readings += 1;
        if let Some(value) = self.station.outputs.get(&id) {
            return Ok(value.clone());
        }
        let Some(given) = self.station.answers.inputs.get(&id).cloned() else {
            // Boolean outputs are false until they are set.
            if is_output && is_boolean {
                return Ok(Value::Boolean(false));
            }
            return Ok(self.without_value(&id, is_output));
        };
        let value = match (&given, is_boolean) {
            (AnswerValue::Boolean(value), _) => Value::Boolean(*value),
            // Single-bit signals are given as 0 and 1 or as booleans.
            (AnswerValue::Integer(bit @ (0 | 1)), true) => Value::Boolean(*bit == 1),
            (AnswerValue::Integer(value), false) => match i32::try_from(*value) {
                Ok(value) => Value::Int(value),
                Err(_) => Value::Long(*value),
            },
            (AnswerValue::Number(value), false) => Value::Double(*value),
            _ => {
                let wanted = if is_boolean { "true or false" } else { "a number, true or false" };
                return self
                    .reject(format!("the input `{id}` is given as `{given}`: it is {wanted}"));
            }
        };
        self.record(QuestionKind::Input, &id, Vec::new(), given.to_string(), true);
        Ok(value)
    }

    /// Returns the value of a signal without a given value: the value on trial, the supposed value
    /// that ends a loop, or unknown.
    fn without_value(&mut self, id: &str, is_output: bool) -> Value {
        if is_output {
            return self.unknown(format!("the output `{id}`, for which no value is given"));
        }
        if let Some((tried, value)) = &self.station.trial
            && tried == id
        {
            return Value::Boolean(*value);
        }
        if let Some(value) = self.station.supposed.get(id).copied() {
            self.record(QuestionKind::Input, id, Vec::new(), value.to_string(), false);
            return Value::Boolean(value);
        }
        self.station.asked.push(Asked {
            kind: QuestionKind::Input,
            subject: id.to_owned(),
            choices: Vec::new(),
            answer: None,
            is_given: false,
        });
        self.unknown(format!("the input `{id}`, for which no value is given"))
    }
}
