//! Evaluator and host interface; the evaluation itself is in the modules named after its subjects.

use std::rc::Rc;

use crate::{
    classes::Classes,
    host_value::HostValue,
    java_state::{JavaState, MAX_NESTING},
    place::SourceLine,
    stop::{EvaluationStop, JavaRefusal},
    unknown::Unknown,
    value::{JavaObject, Thrown, Value},
};

/// Evaluator of a project's classes. It models a running JVM, and tracks its place in the sources.
pub struct Machine {
    /// Current place in the sources.
    pub place: SourceLine,
    /// Notes for the user in order, without duplicates.
    pub notes: Vec<Note>,
    pub(crate) java: JavaState,
    pub(crate) host: Rc<dyn Host>,
}

/// Note for the user of an evaluation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Sentence without its capital and its full stop.
    pub text: String,
    /// Place in the sources.
    pub place: SourceLine,
}

/// Counts of a host's actions and questions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HostCounts {
    /// Number of actions other than pauses: motions.
    pub actions: usize,
    /// Number of questions, with or without an answer.
    pub asked: usize,
    /// Number of answers after which another one is given to the same question.
    pub continued: usize,
    /// Number of readings of parts of the host's state that a program can change.
    pub readings: [usize; 2],
    /// Hashes of these parts.
    pub state: [u64; 2],
}

/// Host of an evaluation, which defines the classes outside the project and the Java library, and
/// the actions: the purpose of the evaluation. For an unmodelled member, optional results are
/// `None`, and the value is unknown.
pub trait Host {
    /// Returns the names of acting methods, of any class.
    fn acting(&self) -> &'static [&'static str];

    /// Returns the acting methods whose receiver must be known.
    fn acting_on_receivers(&self) -> &'static [&'static str];

    /// Describes the actions in messages, such as "the arm moves or waits".
    fn acts(&self) -> &'static str;

    /// Returns the acting methods that only take time.
    fn pausing(&self) -> &'static [&'static str];

    /// Returns the current counts.
    fn progress(&self) -> HostCounts;

    /// Supposes an answer to the only unanswered question since `asked`; `None` drops the
    /// supposition. Returns false if no such question exists.
    fn suppose(&self, asked: usize, answer: Option<bool>) -> bool;

    /// Keeps the supposed answer from here on.
    fn settle(&self);

    /// Reports that a loop without motions ended at the first test of its condition; the questions
    /// since `asked` are those of the condition. `hindrance` is the reason why the loop does more
    /// than wait for one answer, if any.
    ///
    /// # Errors
    ///
    /// If the evaluation ends here.
    fn passed_loop(
        &self,
        _machine: &mut Machine,
        _asked: usize,
        _hindrance: Option<&'static str>,
    ) -> Result<(), EvaluationStop> {
        Ok(())
    }

    /// Describes the answers since `asked` that keep a loop running, such as "the input `A.B`,
    /// which is given as false".
    fn answers_since(&self, asked: usize) -> Option<String>;

    /// Reports that a loop is endless with the answers since `asked`.
    fn endless(&self, machine: &Machine, asked: usize);

    /// Evaluates `receiver.name(arguments)`.
    ///
    /// # Errors
    ///
    /// If an exception is thrown, or if the evaluation ends here.
    fn call(
        &self,
        machine: &mut Machine,
        receiver: &Rc<dyn HostValue>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop>;

    /// Evaluates `receiver.name`.
    ///
    /// # Errors
    ///
    /// If an exception is thrown, or if the evaluation ends here.
    fn field(
        &self,
        machine: &mut Machine,
        receiver: &Rc<dyn HostValue>,
        name: &str,
    ) -> Result<Value, EvaluationStop>;

    /// Evaluates `Class.name(arguments)`.
    ///
    /// # Errors
    ///
    /// If an exception is thrown, or if the evaluation ends here.
    fn call_static(
        &self,
        machine: &mut Machine,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop>;

    /// Evaluates `new Class(arguments)`.
    ///
    /// # Errors
    ///
    /// If an exception is thrown, or if the evaluation ends here.
    fn construct(
        &self,
        machine: &mut Machine,
        class: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop>;

    /// Evaluates `Class.name`.
    ///
    /// # Errors
    ///
    /// If an exception is thrown, or if the evaluation ends here.
    fn constant(
        &self,
        machine: &mut Machine,
        class: &str,
        name: &str,
    ) -> Result<Option<Value>, EvaluationStop>;

    /// Returns the value for a field or a parameter of this class that is annotated with `@Inject`,
    /// and optionally with `@Named`.
    ///
    /// # Errors
    ///
    /// If an exception is thrown, or if the evaluation ends here.
    fn injected(
        &self,
        machine: &mut Machine,
        class: &str,
        named: Option<&str>,
        field: &str,
    ) -> Result<Option<Value>, EvaluationStop>;

    /// Evaluates `object.name(arguments)` for a method that no project class has; `base` is the
    /// first superclass outside the project.
    ///
    /// # Errors
    ///
    /// If an exception is thrown, or if the evaluation ends here.
    fn inherited(
        &self,
        machine: &mut Machine,
        object: &Rc<JavaObject>,
        base: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop>;

    /// Runs the constructor of `base` on `object`.
    ///
    /// # Errors
    ///
    /// If an exception is thrown, or if the evaluation ends here.
    fn constructed(
        &self,
        machine: &mut Machine,
        object: &Rc<JavaObject>,
        base: &str,
        arguments: &[Value],
    ) -> Result<(), EvaluationStop>;

    /// Converts a value to text for string concatenation.
    fn text(&self, value: &Rc<dyn HostValue>) -> String;
}

impl Machine {
    /// Creates an evaluator in its initial state.
    #[must_use]
    pub fn new(classes: Classes, host: Rc<dyn Host>, place: SourceLine) -> Self {
        Self { place, notes: Vec::new(), java: JavaState::new(classes), host }
    }

    /// Runs `inner` one nesting level deeper; the depth of statements and expressions is bounded,
    /// as the stack is.
    pub(crate) fn deeper<T>(
        &mut self,
        inner: impl FnOnce(&mut Self) -> Result<T, EvaluationStop>,
    ) -> Result<T, EvaluationStop> {
        if self.java.nesting >= MAX_NESTING {
            return self.reject("statements and expressions are nested too deeply");
        }
        self.java.nesting += 1;
        let result = inner(self);
        self.java.nesting -= 1;
        result
    }

    /// Returns the place where code outside of the project classes that extend `base`, a class
    /// outside the project, has called them; the current place if they are not running.
    #[must_use]
    pub fn place_outside(&self, base: &str) -> SourceLine {
        let calls = self.java.activations.iter().rev();
        calls
            .take_while(|call| self.java.classes.foreign_parent(call.class) == Some(base))
            .last()
            .map_or_else(|| self.place.clone(), |call| call.from.clone())
    }

    /// Adds a note for the user, unless it exists.
    pub fn note(&mut self, text: impl Into<String>) {
        let note = Note { text: text.into(), place: self.place.clone() };
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// Ends the evaluation with a refusal at the current place.
    ///
    /// # Errors
    ///
    /// Always: the refusal.
    pub fn reject<T>(&self, reason: impl Into<String>) -> Result<T, EvaluationStop> {
        Err(EvaluationStop::Refused(Box::new(JavaRefusal {
            reason: reason.into(),
            place: self.place.clone(),
        })))
    }

    /// Ends the evaluation because `subject` (such as "the target of this motion") is unknown.
    ///
    /// # Errors
    ///
    /// Always: the refusal.
    pub fn reject_unknown<T>(&self, subject: &str, unknown: &Unknown) -> Result<T, EvaluationStop> {
        let Unknown { reason, place, .. } = unknown;
        let from = if *place == self.place { String::new() } else { format!(" ({place})") };
        self.reject(format!("{subject} depends on {reason}{from}"))
    }

    /// Creates an unknown value with a reason at the current place.
    #[must_use]
    pub fn unknown(&self, reason: impl Into<String>) -> Value {
        let (reason, place) = (reason.into(), self.place.clone());
        Value::Unknown(Rc::new(Unknown { reason, place, is_unmodelled_call: false }))
    }

    /// Creates the unknown result of an unmodelled method; `owner` names its owner, such as
    /// ` of a list`, or empty.
    #[must_use]
    pub fn unmodelled_result(&self, method: &str, owner: &str) -> Value {
        let reason = format!("the result of `{method}`{owner}, which is not known");
        Value::Unknown(Rc::new(Unknown {
            reason,
            place: self.place.clone(),
            is_unmodelled_call: true,
        }))
    }

    /// Throws a Java or host exception, by its simple name.
    ///
    /// # Errors
    ///
    /// Always: the exception.
    pub fn throw<T>(&self, class: &str, message: impl Into<String>) -> Result<T, EvaluationStop> {
        let message = message.into();
        // Our exception messages differ from Java's, except for these classes.
        let value = match class {
            "ArithmeticException" | "NumberFormatException" => Value::text(&message),
            _ => self.unknown("the message of an exception of Java"),
        };
        Err(EvaluationStop::Thrown(Rc::new(Thrown {
            classes: vec![Rc::from(class)],
            value,
            message,
            place: self.place.clone(),
        })))
    }
}
