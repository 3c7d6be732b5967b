//! Threads, timers and executors.

use std::rc::Rc;

use iiwa_java::{EvaluationStop, Unknown, Value};

use crate::application::robotics::Robotics;

/// Methods by which a task interferes with other motions: stops, slows or redirects them.
const INTERFERING: [&str; 13] = [
    "cancel",
    "cancelAll",
    "pause",
    "halt",
    "startPause",
    "stop",
    "setApplicationOverride",
    "clipApplicationOverride",
    "clipManualOverride",
    "setTransformationFromParent",
    "changeFrameTransformation",
    "setMass",
    "setValue",
];

impl Robotics<'_> {
    /// Calls a method of a thread, a timer or an executor; `receiver` is the thread itself, or its
    /// task.
    pub(crate) fn call_thread(
        &mut self,
        receiver: Option<&Value>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match (name, arguments) {
            (
                "start"
                | "run"
                | "submit"
                | "execute"
                | "schedule"
                | "scheduleAtFixedRate"
                | "scheduleWithFixedDelay",
                _,
            ) => {
                let given =
                    arguments.iter().find(|argument| argument.is_task()).or(receiver).cloned();
                self.start(given.as_ref())
            }
            ("sleep", [amount]) => self.sleep_ms(amount),
            (
                "join" | "interrupt" | "cancel" | "purge" | "shutdown" | "shutdownNow"
                | "setDaemon" | "setName" | "setPriority",
                _,
            ) => Ok(Value::Null),
            ("isInterrupted" | "interrupted", _) => Ok(Value::Boolean(false)),
            _ => Ok(self.unknown("what a thread does")),
        }
    }

    /// Starts a task: it is left out if it neither moves the robot nor interferes with motions;
    /// values that it sets are unknown then.
    fn start(&mut self, task: Option<&Value>) -> Result<Value, EvaluationStop> {
        let unknown = Unknown {
            reason: "what a thread does".to_owned(),
            place: self.place.clone(),
            is_unmodelled_call: false,
        };
        let unknown = Rc::new(unknown);
        let effects = task.and_then(|task| self.start_task(task, &INTERFERING, &unknown));
        let call = effects.as_ref().and_then(|effects| {
            let call = INTERFERING.iter().find(|name| effects.calls.contains(**name));
            call.map(|name| format!(", and it calls `{name}`"))
        });
        match effects {
            Some(effects) if !effects.moves && call.is_none() => {
                self.note(
                    "a thread is started, which does not move the arm: what it does is left \
                    out of the plan",
                );
                Ok(Value::Unknown(unknown))
            }
            _ => self.reject(format!(
                "a thread is started{}: what it does to the arm, and when, is not known ahead; \
                 call it from the application itself, or leave it out",
                call.unwrap_or_default()
            )),
        }
    }
}
