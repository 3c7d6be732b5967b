//! Process data, which the operator may change.

use crate::{AnswerValue, QuestionKind};
use iiwa_java::{EvaluationStop, Value};
use iiwa_json::meant;

use crate::application::{
    asked::Asked,
    missing::Missing,
    robot_value::{RobotValue, robot},
    robotics::Robotics,
};

impl Robotics<'_> {
    /// Evaluates `getProcessData(id)`.
    pub(crate) fn process_data(&mut self, id: &Value) -> Result<Value, EvaluationStop> {
        let id = match id {
            Value::Text(id) => id.clone(),
            Value::Unknown(unknown) => return Ok(Value::Unknown(unknown.clone())),
            _ => return self.reject("process data are named by a string"),
        };
        let known = self.station.process_data.iter().map(|data| data.id.as_str());
        let known: Vec<&str> = known.collect();
        if known.contains(&&*id) || self.station.answers.data.contains_key(&*id) {
            return Ok(robot(RobotValue::ProcessData(id)));
        }
        self.station.missing.replace(Some(Missing::ProcessData(id.to_string())));
        let suggestion = match meant(&id, known) {
            Some(meant) => format!("; did you mean `{meant}`?"),
            None => String::new(),
        };
        self.reject(format!(
            "the data file has no process data `{id}`{suggestion}; an answer, `[data]`, gives it a \
             value"
        ))
    }

    /// Calls a method of process data.
    pub(crate) fn call_process_data(
        &mut self,
        id: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match (name, arguments) {
            ("getValue", []) => {
                self.station.readings += 1;
                if let Some(value) = self.station.changed_data.get(id) {
                    return Ok(value.clone());
                }
                let given = self.station.answers.data.get(id).cloned();
                let is_given = given.is_some();
                let stated =
                    || self.stated(id, |data| data.value.clone().or(data.default_value.clone()));
                let Some(answer) = given.map(|given| given.to_string()).or_else(stated) else {
                    self.station.asked.push(Asked {
                        kind: QuestionKind::ProcessData,
                        subject: id.to_owned(),
                        choices: Vec::new(),
                        answer: None,
                        is_given: false,
                    });
                    return Ok(self
                        .unknown(format!("the process data `{id}`, for which no value is given")));
                };
                self.record(QuestionKind::ProcessData, id, Vec::new(), answer.clone(), is_given);
                self.typed(id, &answer)
            }
            ("setValue", [value]) => {
                self.station.changed_data.insert(id.to_owned(), value.clone());
                Ok(Value::Null)
            }
            ("getDefaultValue", []) => {
                self.stated_value(id, name, |data| data.default_value.clone())
            }
            ("getMin" | "getMinValue", []) => self.stated_value(id, name, |data| data.min.clone()),
            ("getMax" | "getMaxValue", []) => self.stated_value(id, name, |data| data.max.clone()),
            ("getId" | "getName", []) => Ok(Value::text(id)),
            _ => Ok(self.not_known(&format!("IProcessData.{name}"))),
        }
    }

    fn stated(
        &self,
        id: &str,
        value_of: impl Fn(&crate::ProcessData) -> Option<String>,
    ) -> Option<String> {
        self.station.process_data.iter().find(|data| data.id == id).and_then(value_of)
    }

    fn stated_value(
        &mut self,
        id: &str,
        name: &str,
        value_of: impl Fn(&crate::ProcessData) -> Option<String>,
    ) -> Result<Value, EvaluationStop> {
        match self.stated(id, value_of) {
            Some(text) => self.typed(id, &text),
            None => Ok(self.not_known(&format!("IProcessData.{name}"))),
        }
    }

    /// Converts a text to a value of the class in the data file.
    fn typed(&mut self, id: &str, text: &str) -> Result<Value, EvaluationStop> {
        let data_type = self.stated(id, |data| Some(data.data_type.clone())).unwrap_or_default();
        let class = data_type.rsplit('.').next().unwrap_or_default().to_owned();
        let text = text.trim();
        let value = match class.as_str() {
            // Workbench writes `True` and `False`; Java accepts both in any case.
            "Boolean" => text.to_ascii_lowercase().parse().ok().map(Value::Boolean),
            "Integer" | "Short" | "Byte" => text.parse().ok().map(Value::Int),
            "Long" => text.parse().ok().map(Value::Long),
            "Double" | "Float" => {
                text.parse().ok().filter(|number: &f64| number.is_finite()).map(Value::Double)
            }
            "String" => Some(Value::text(text)),
            _ => Some(match AnswerValue::of_text(text) {
                AnswerValue::Boolean(value) => Value::Boolean(value),
                AnswerValue::Integer(value) => match i32::try_from(value) {
                    Ok(value) => Value::Int(value),
                    Err(_) => Value::Long(value),
                },
                AnswerValue::Number(value) => Value::Double(value),
                AnswerValue::Text(text) => Value::text(text),
            }),
        };
        match value {
            Some(value) => Ok(value),
            None => {
                self.reject(format!("the process data `{id}` are `{text}`, which is not a {class}"))
            }
        }
    }
}
