//! Signals in the imported program: outputs that the application sets, and waits for inputs.

use std::rc::Rc;

use iiwa_java::{EvaluationStop, Value};
use iiwa_program::{IoEntry, IoValue, MAX_OVERLAP, Motion};

use crate::{
    QuestionKind,
    application::{
        arguments::robot_value,
        robot_value::{Opaque, RobotValue, SignalValue, robot},
        robotics::Robotics,
    },
};

/// Converts the value of a signal; `None` if the value is neither boolean nor a number.
fn io_value(value: &Value) -> Option<IoValue> {
    match value {
        Value::Boolean(value) => Some(IoValue::Boolean(*value)),
        Value::Float(_) | Value::Double(_) => value.number().map(IoValue::Analog),
        _ => match value.integer().map(u64::try_from) {
            Some(Ok(value)) => Some(IoValue::Digital(value)),
            _ => value.number().map(IoValue::Analog),
        },
    }
}

impl Robotics<'_> {
    /// Sets an output, in the evaluation and in the program.
    pub(crate) fn set_output(
        &mut self,
        group: &str,
        signal: &str,
        value: &Value,
    ) -> Result<Value, EvaluationStop> {
        let id = format!("{group}.{signal}");
        self.station.outputs.insert(id.clone(), value.clone());
        match io_value(value) {
            Some(value) => self.add_io(IoEntry::set(id, value))?,
            None => self.note(format!(
                "the value that the output `{id}` gets is unknown: the program does not set it"
            )),
        }
        Ok(Value::Null)
    }

    /// Adds an input or output to the program, while the robot continues its motions.
    fn add_io(&mut self, entry: IoEntry) -> Result<(), EvaluationStop> {
        self.check(&Motion::Io(entry.clone()))?;
        let overlap = self.station.schedule.under_way();
        if overlap > MAX_OVERLAP {
            return self.reject(format!(
                "an input or output is used while {overlap} motions are under way; it can be \
                 {MAX_OVERLAP}"
            ));
        }
        // The statement of the application, not that of the generated class of the group.
        let place = self.place_outside("AbstractIOGroup");
        self.station.schedule.io(entry, place);
        Ok(())
    }

    /// Adds a wait for the signal of a condition, which takes `seconds`; other conditions are plain
    /// waits.
    pub(crate) fn wait_for_signal(
        &mut self,
        condition: &Value,
        seconds: f64,
    ) -> Result<(), EvaluationStop> {
        if let Some(RobotValue::Opaque(condition)) = robot_value(condition)
            && let Some(SignalValue { id, value: Some(value) }) = &condition.signal
        {
            return self.add_io(IoEntry::wait_for(&**id, IoValue::Boolean(*value), seconds));
        }
        if seconds > 0.0 { self.wait(seconds) } else { Ok(()) }
    }

    /// Adds a wait for an input after a loop that waits for nothing else; the questions since
    /// `since` are those of its condition, and `hindrance` is the reason why the loop does more, if
    /// any. The time is that of an answer, by default 0.
    pub(crate) fn wait_in_loop(
        &mut self,
        since: usize,
        hindrance: Option<&str>,
    ) -> Result<(), EvaluationStop> {
        let asked = self.station.asked.get(since..).unwrap_or_default();
        // The last answer ends the loop.
        let Some(last) = asked.last().filter(|last| last.kind == QuestionKind::Input) else {
            return Ok(());
        };
        let is_one = asked.iter().all(|it| it.kind == last.kind && it.subject == last.subject);
        let value = last.answer.as_deref().and_then(|answer| answer.parse().ok());
        let id = last.subject.clone();
        let hindrance = match value {
            None => Some("its value is not true or false"),
            Some(_) if !is_one => Some("the loop asks for more than this input"),
            Some(_) => hindrance,
        };
        let (None, Some(value)) = (hindrance, value) else {
            let why = hindrance.unwrap_or_default();
            self.note(format!(
                "the loop ends by the input `{id}`, and the program does not wait for it: {why}"
            ));
            return Ok(());
        };
        let seconds = self.stated_seconds()?;
        self.add_io(IoEntry::wait_for(id, IoValue::Boolean(value), seconds))
    }
}

/// Returns the signal `Group.Name` of a group, as an object.
pub(crate) fn signal(group: &str, name: &str) -> Value {
    let signal = SignalValue { id: Rc::from(format!("{group}.{name}")), value: None };
    robot(RobotValue::Opaque(Rc::new(Opaque::of_signal("AbstractIO", signal))))
}

/// Returns the condition that a boolean signal has a value; `None` for other arguments.
pub(crate) fn signal_condition(class: &str, arguments: &[Value]) -> Option<Value> {
    let ("BooleanIOCondition", [signal, Value::Boolean(value)]) = (class, arguments) else {
        return None;
    };
    let Some(RobotValue::Opaque(signal)) = robot_value(signal) else { return None };
    let id = Rc::clone(&signal.signal.as_ref()?.id);
    let signal = SignalValue { id, value: Some(*value) };
    Some(robot(RobotValue::Opaque(Rc::new(Opaque::of_signal("ICondition", signal)))))
}
