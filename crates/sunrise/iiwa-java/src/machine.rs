//! The evaluator's state; what it does is in the files that are named after it.

use std::rc::Rc;

use crate::{
    classes::Classes,
    host_value::HostValue,
    java_state::{JavaState, MAX_NESTING},
    place::Place,
    stop::{Refusal, Stop},
    unknown::Unknown,
    value::{Object, Thrown, Value},
};

/// What evaluates the classes of a project. It stands for a Java that runs them, and knows at each step where it is.
pub struct Machine {
    /// Where it is in the sources.
    pub here: Place,
    /// What the user should know of the evaluation, in order, each once.
    pub notes: Vec<Note>,
    pub(crate) java: JavaState,
    pub(crate) host: Rc<dyn Host>,
}

/// What the user should know of an evaluation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// A sentence without its capital and its full stop.
    pub text: String,
    /// What it is about.
    pub place: Place,
}

/// Counts of what a host has done and asked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Actions other than pauses: motions.
    pub actions: usize,
    /// Questions, however they were answered.
    pub asked: usize,
    /// Answers after which another one is given to the same question.
    pub continued: usize,
    /// Readings of parts of the host's state that a program can change.
    pub readings: [usize; 2],
    /// These parts, as hashes.
    pub state: [u64; 2],
}

/// Whoever knows the classes that are neither of the project nor of Java's own library, and what it means to act: to do what an
/// evaluation is for. Where something is not known, it answers nothing, and the value is unknown.
pub trait Host {
    /// Names of the methods that act, of any class.
    fn acting(&self) -> &'static [&'static str];

    /// Those of them of which it has to be known what they are called on.
    fn acting_on_receivers(&self) -> &'static [&'static str];

    /// What acting is, in messages: "the arm moves or waits".
    fn acts(&self) -> &'static str;

    /// The acting methods that only take time.
    fn pausing(&self) -> &'static [&'static str];

    /// Counts of what was done so far.
    fn progress(&self) -> Progress;

    /// Supposes an answer to the only question since `asked` that has none; `None` drops the supposition. False if there is no
    /// such question.
    fn suppose(&self, asked: usize, answer: Option<bool>) -> bool;

    /// Makes the supposed answer the one that is taken from here on.
    fn settle(&self);

    /// Describes the answers since `asked` that keep a loop going, such as "the input `A.B`, which is given as false".
    fn answers_since(&self, asked: usize) -> Option<String>;

    /// Is told that a loop goes on for ever by the answers since `asked`.
    fn endless(&self, machine: &Machine, asked: usize);

    /// `receiver.name(arguments)`.
    ///
    /// # Errors
    ///
    /// An exception, or that the evaluation ends here.
    fn call(
        &self,
        machine: &mut Machine,
        receiver: &Rc<dyn HostValue>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, Stop>;

    /// `receiver.name`.
    ///
    /// # Errors
    ///
    /// An exception, or that the evaluation ends here.
    fn field(
        &self,
        machine: &mut Machine,
        receiver: &Rc<dyn HostValue>,
        name: &str,
    ) -> Result<Value, Stop>;

    /// `Class.name(arguments)`.
    ///
    /// # Errors
    ///
    /// An exception, or that the evaluation ends here.
    fn call_static(
        &self,
        machine: &mut Machine,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, Stop>;

    /// `new Class(arguments)`.
    ///
    /// # Errors
    ///
    /// An exception, or that the evaluation ends here.
    fn construct(
        &self,
        machine: &mut Machine,
        class: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, Stop>;

    /// `Class.name`.
    ///
    /// # Errors
    ///
    /// An exception, or that the evaluation ends here.
    fn constant(
        &self,
        machine: &mut Machine,
        class: &str,
        name: &str,
    ) -> Result<Option<Value>, Stop>;

    /// What is put into a field or a parameter of this class that is marked with `@Inject`, and perhaps with `@Named`.
    ///
    /// # Errors
    ///
    /// An exception, or that the evaluation ends here.
    fn injected(
        &self,
        machine: &mut Machine,
        class: &str,
        named: Option<&str>,
        field: &str,
    ) -> Result<Option<Value>, Stop>;

    /// `object.name(arguments)`, of a method that no class of the project has; `base` is the first class above that is not of
    /// the project.
    ///
    /// # Errors
    ///
    /// An exception, or that the evaluation ends here.
    fn inherited(
        &self,
        machine: &mut Machine,
        object: &Rc<Object>,
        base: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, Stop>;

    /// The constructor of that class is run on `object`.
    ///
    /// # Errors
    ///
    /// An exception, or that the evaluation ends here.
    fn constructed(
        &self,
        machine: &mut Machine,
        object: &Rc<Object>,
        base: &str,
        arguments: &[Value],
    ) -> Result<(), Stop>;

    /// What a string holds of a value when it is appended.
    fn text(&self, value: &Rc<dyn HostValue>) -> String;
}

impl Machine {
    /// One that has run nothing yet.
    #[must_use]
    pub fn new(classes: Classes, host: Rc<dyn Host>, here: Place) -> Self {
        Self { here, notes: Vec::new(), java: JavaState::new(classes), host }
    }

    /// One level further down in statements and expressions, which are bounded, as the stack is.
    pub(crate) fn deeper<T>(
        &mut self,
        inner: impl FnOnce(&mut Self) -> Result<T, Stop>,
    ) -> Result<T, Stop> {
        if self.java.nesting >= MAX_NESTING {
            return self.refuse("statements and expressions are nested too deeply");
        }
        self.java.nesting += 1;
        let result = inner(self);
        self.java.nesting -= 1;
        result
    }

    /// Tells the user of something, once.
    pub fn note(&mut self, text: impl Into<String>) {
        let note = Note { text: text.into(), place: self.here.clone() };
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// Ends the evaluation, by what is here.
    ///
    /// # Errors
    ///
    /// Always: the refusal.
    pub fn refuse<T>(&self, reason: impl Into<String>) -> Result<T, Stop> {
        Err(Stop::Refused(Box::new(Refusal { reason: reason.into(), place: self.here.clone() })))
    }

    /// Ends it, since `what` (as "the target of this motion") is not known.
    ///
    /// # Errors
    ///
    /// Always: the refusal.
    pub fn refuse_unknown<T>(&self, what: &str, unknown: &Unknown) -> Result<T, Stop> {
        let Unknown { reason, place, .. } = unknown;
        let from = if *place == self.here { String::new() } else { format!(" ({place})") };
        self.refuse(format!("{what} depends on {reason}{from}"))
    }

    /// A value that cannot be known, for a reason that is here.
    #[must_use]
    pub fn unknown(&self, reason: impl Into<String>) -> Value {
        let (reason, place) = (reason.into(), self.here.clone());
        Value::Unknown(Rc::new(Unknown { reason, place, is_unmodelled_call: false }))
    }

    /// The result of a method that is not modelled; `of` is what the method belongs to, such as ` of a list`, or empty.
    #[must_use]
    pub fn unmodelled_result(&self, method: &str, of: &str) -> Value {
        let reason = format!("the result of `{method}`{of}, which is not known");
        Value::Unknown(Rc::new(Unknown {
            reason,
            place: self.here.clone(),
            is_unmodelled_call: true,
        }))
    }

    /// An exception of Java's or the host's, by its simple name.
    ///
    /// # Errors
    ///
    /// Always: the exception.
    pub fn throw<T>(&self, class: &str, message: impl Into<String>) -> Result<T, Stop> {
        let message = message.into();
        // Those of Java's own exceptions are others than ours, but for these.
        let value = match class {
            "ArithmeticException" | "NumberFormatException" => Value::text(&message),
            _ => self.unknown("the message of an exception of Java"),
        };
        Err(Stop::Thrown(Rc::new(Thrown {
            classes: vec![Rc::from(class)],
            value,
            message,
            place: self.here.clone(),
        })))
    }
}
