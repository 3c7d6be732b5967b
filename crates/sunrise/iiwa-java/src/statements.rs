//! Execution of statements.

use std::rc::Rc;

use crate::{
    flow::Flow,
    java_state::MAX_STEPS,
    machine::Machine,
    read::completes,
    static_types::NUMBER,
    stop::EvaluationStop,
    syntax::{Catch, Expression, ExpressionKind, Literal, Statement, StatementKind},
    type_names::NULL,
    unknown::Unknown,
    value::{Thrown, Value},
};

/// Value of a condition, or the unknown value that it depends on.
pub(crate) type Condition = Result<bool, Rc<Unknown>>;

impl Machine {
    /// Runs statements in a new scope.
    pub(crate) fn block(&mut self, statements: &[Statement]) -> Result<Flow, EvaluationStop> {
        let outside = self.local_count();
        let flow = self.statements(statements);
        self.forget_locals(outside);
        flow
    }

    pub(crate) fn statements(&mut self, statements: &[Statement]) -> Result<Flow, EvaluationStop> {
        for statement in statements {
            match self.statement(statement)? {
                Flow::Next => {}
                other => return Ok(other),
            }
        }
        Ok(Flow::Next)
    }

    pub(crate) fn local_count(&self) -> usize {
        self.java.activation().map_or(0, |activation| activation.locals.len())
    }

    pub(crate) fn forget_locals(&mut self, outside: usize) {
        if let Some(locals) = self.java.locals_mut() {
            locals.truncate(outside);
        }
    }

    pub(crate) fn statement(&mut self, statement: &Statement) -> Result<Flow, EvaluationStop> {
        self.place.line = statement.line;
        self.count_step()?;
        self.deeper(|machine| machine.run_statement(statement))
    }

    /// Counts a statement, or a function that the library runs.
    pub(crate) fn count_step(&mut self) -> Result<(), EvaluationStop> {
        self.java.steps += 1;
        if self.java.steps > MAX_STEPS {
            return self
                .reject("the application takes more than 100 000 steps: a loop may have no end");
        }
        Ok(())
    }

    fn run_statement(&mut self, statement: &Statement) -> Result<Flow, EvaluationStop> {
        match &statement.kind {
            StatementKind::Block(body) | StatementKind::Synchronized { body } => self.block(body),
            StatementKind::Local { type_name, variables } => {
                for variable in variables {
                    let dimensions = type_name.dimensions + variable.dimensions;
                    let type_name = type_name.with_dimensions(dimensions);
                    let inferred = variable.initial.as_ref().filter(|_| type_name.name == "var");
                    let type_name = inferred
                        .and_then(|initial| self.static_type(initial))
                        .filter(|type_name| type_name.name != NULL && type_name.name != NUMBER)
                        .unwrap_or(type_name);
                    let outside = self.local_count();
                    let value = match &variable.initial {
                        Some(initial) => self.initial_value(initial, &type_name)?,
                        None => Value::default_of(&type_name),
                    };
                    self.forget_locals(outside);
                    self.java.declare(&variable.name, Some(&type_name), value);
                    if let Some(local) = self.java.locals_mut().and_then(|locals| locals.last_mut())
                    {
                        local.is_assigned = variable.initial.is_some();
                    }
                }
                Ok(Flow::Next)
            }
            // Local classes are resolved where their name is used.
            StatementKind::LocalClass(class) => {
                if let Some(outer) = self.java.activation().map(|activation| activation.class) {
                    let id = self.class_in_method(class, outer);
                    self.java.declare(&class.name, None, Value::Class(id));
                }
                Ok(Flow::Next)
            }
            StatementKind::Expression(value) => {
                let outside = self.local_count();
                self.evaluated(value)?;
                self.forget_locals(outside);
                Ok(Flow::Next)
            }
            StatementKind::If { condition, then_branch, otherwise } => {
                let line = self.place.line;
                let outside = self.local_count();
                let condition = self.condition(condition)?;
                let flow = match condition {
                    Ok(true) => self.scoped(then_branch),
                    Ok(false) => otherwise
                        .as_ref()
                        .map_or(Ok(Flow::Next), |statement| self.scoped(statement)),
                    Err(unknown) => {
                        self.place.line = line;
                        let branches = std::iter::once(&**then_branch).chain(otherwise.as_deref());
                        self.passed_over(branches, "branch", &unknown)
                    }
                };
                // A pattern variable remains in scope after a branch that cannot complete normally
                // (JLS 6.3.2.2).
                if otherwise.is_some() || completes(then_branch) {
                    self.forget_locals(outside);
                }
                flow
            }
            StatementKind::While { .. }
            | StatementKind::DoWhile { .. }
            | StatementKind::For { .. }
            | StatementKind::ForEach { .. } => self.repeated(statement, None),
            StatementKind::Labelled { label, body } => match self.labelled(body, label)? {
                Flow::Break(Some(target)) if target == *label => Ok(Flow::Next),
                other => Ok(other),
            },
            StatementKind::Switch { value, groups } => self.switch(statement, value, groups),
            StatementKind::Break(label) => Ok(Flow::Break(label.clone())),
            StatementKind::Continue(label) => Ok(Flow::Continue(label.clone())),
            StatementKind::Return(value) => {
                let value = value
                    .as_ref()
                    .map_or(Ok(Value::Null), |expression| self.evaluated(expression))?;
                Ok(Flow::Return(value))
            }
            StatementKind::Yield(value) => Ok(Flow::Yield(self.evaluated(value)?)),
            StatementKind::Throw(value) => {
                let value = self.evaluated(value)?;
                self.place.line = statement.line;
                self.thrown(value)
            }
            StatementKind::Try { resources, body, catches, finally } => {
                let outside = self.local_count();
                let result = self.tried(resources, body, catches);
                self.forget_locals(outside);
                self.finally(result, finally.as_deref())
            }
            StatementKind::Assert | StatementKind::Empty => Ok(Flow::Next),
            StatementKind::Unsupported(construct) => {
                self.reject(format!("{construct} cannot be evaluated"))
            }
        }
    }

    fn labelled(&mut self, body: &Statement, label: &str) -> Result<Flow, EvaluationStop> {
        match &body.kind {
            StatementKind::While { .. }
            | StatementKind::DoWhile { .. }
            | StatementKind::For { .. }
            | StatementKind::ForEach { .. } => self.repeated(body, Some(label)),
            _ => self.statement(body),
        }
    }

    /// Runs a statement in a new scope.
    pub(crate) fn scoped(&mut self, statement: &Statement) -> Result<Flow, EvaluationStop> {
        let outside = self.local_count();
        let flow = self.statement(statement);
        self.forget_locals(outside);
        flow
    }

    pub(crate) fn condition(
        &mut self,
        condition: &Expression,
    ) -> Result<Condition, EvaluationStop> {
        match self.evaluated(condition)? {
            Value::Boolean(value) => Ok(Ok(value)),
            Value::Unknown(unknown) => Ok(Err(unknown)),
            Value::Null => self.throw("NullPointerException", "a condition is null"),
            other => self.reject(format!("a condition is {}", other.kind())),
        }
    }

    /// Skips statements that depend on an unknown value, and marks the values that they may change
    /// as unknown; refuses them if they would act.
    pub(crate) fn passed_over<'s>(
        &mut self,
        statements: impl IntoIterator<Item = &'s Statement>,
        statement_kind: &str,
        unknown: &Rc<Unknown>,
    ) -> Result<Flow, EvaluationStop> {
        let acts = self.host.acts();
        let mut effects = self.effects_of(statements);
        if effects.acts() {
            return self.reject_unknown(
                &format!("whether this {statement_kind}, in which {acts}, is taken"),
                unknown,
            );
        }
        if !effects.leaves && !effects.continues {
            self.forget_values(&effects, unknown);
            return Ok(Flow::Next);
        }
        // The rest of the method may or may not run, so that it must not act either.
        let names = self
            .java
            .activation()
            .map(|activation| (activation.method.clone(), activation.lambda.clone()));
        let (method, lambda) = names.unwrap_or_default();
        effects = match &lambda {
            Some(lambda) => self.effects_of(&lambda.body),
            None => self.effects_of_method(&method),
        };
        if effects.acts() || (method.is_empty() && lambda.is_none()) {
            return self.reject_unknown(
                &format!("whether this {statement_kind} leaves what is around it, where {acts},"),
                unknown,
            );
        }
        self.forget_values(&effects, unknown);
        Ok(Flow::Return(Value::Unknown(Rc::clone(unknown))))
    }

    fn tried(
        &mut self,
        resources: &[Statement],
        body: &[Statement],
        catches: &[Catch],
    ) -> Result<Flow, EvaluationStop> {
        let depth = self.java.activations.len();
        let file = Rc::clone(&self.place.file);
        let inner = self.local_count();
        let result = match self.statements(resources) {
            Ok(Flow::Next) => self.statements(body),
            other => other,
        };
        let Err(EvaluationStop::Thrown(thrown)) = result else { return result };
        // The methods between `throw` and `catch` have ended.
        self.java.activations.truncate(depth);
        self.place.file = file;
        self.forget_locals(inner);
        for catch in catches {
            if catch.types.iter().any(|type_name| self.catches(&type_name.name, &thrown)) {
                self.java.declare(&catch.name, None, value_of(&thrown));
                return self.statements(&catch.body);
            }
        }
        Err(EvaluationStop::Thrown(thrown))
    }

    /// Runs a `finally` block, however the `try` statement ended.
    fn finally(
        &mut self,
        result: Result<Flow, EvaluationStop>,
        finally: Option<&[Statement]>,
    ) -> Result<Flow, EvaluationStop> {
        let Some(finally) = finally else { return result };
        if matches!(result, Err(EvaluationStop::Refused(_) | EvaluationStop::Ended)) {
            return result;
        }
        match self.block(finally)? {
            Flow::Next => result,
            other => Ok(other),
        }
    }

    fn thrown<T>(&mut self, value: Value) -> Result<T, EvaluationStop> {
        let place = self.place.clone();
        let thrown = match value {
            Value::Exception(thrown) => thrown,
            Value::Unknown(unknown) => {
                return self.reject_unknown("the exception that is thrown here", &unknown);
            }
            Value::Object(object) => {
                let classes = &self.java.classes;
                let foreign = classes.foreign_parent(object.class).unwrap_or("Exception");
                let text = object.message.borrow().clone();
                let message = match text {
                    Some(Value::Text(text)) => text.to_string(),
                    _ => classes.known(object.class).class.name.clone(),
                };
                Rc::new(Thrown {
                    classes: vec![Rc::from(foreign)],
                    value: Value::Object(object),
                    message,
                    place,
                })
            }
            Value::Null => return self.throw("NullPointerException", "what is thrown is null"),
            other => return self.reject(format!("{} is thrown", other.kind())),
        };
        Err(EvaluationStop::Thrown(thrown))
    }

    /// Returns true if a `catch` of this type catches an exception.
    fn catches(&self, name: &str, thrown: &Thrown) -> bool {
        /// Checked exceptions, which are not `RuntimeException`s.
        const INPUT_OUTPUT: [&str; 8] = [
            "IOException",
            "FileNotFoundException",
            "UnknownHostException",
            "EOFException",
            "SocketException",
            "ConnectException",
            "SocketTimeoutException",
            "MalformedURLException",
        ];
        const CHECKED: [&str; 5] = [
            "Exception",
            "InterruptedException",
            "TimeoutException",
            "ExecutionException",
            "ClassNotFoundException",
        ];
        let class = thrown.classes.first().map_or("Exception", |class| class);
        let thrown_class = match &thrown.value {
            Value::Object(object) => Some(object.class),
            _ => None,
        };
        let simple = crate::classes::simple(name);
        let known = self
            .java
            .activation()
            .and_then(|activation| self.java.classes.find(name, activation.class));
        if let (Some(thrown_class), Some(known)) = (thrown_class, known) {
            return self.java.classes.is_a(thrown_class, known);
        }
        match simple {
            "Throwable" => true,
            "Exception" => !class.ends_with("Error"),
            "RuntimeException" => {
                !class.ends_with("Error")
                    && !CHECKED.contains(&class)
                    && !INPUT_OUTPUT.contains(&class)
            }
            "IOException" => INPUT_OUTPUT.contains(&class),
            "IndexOutOfBoundsException" => class.ends_with("IndexOutOfBoundsException"),
            "IllegalArgumentException" => {
                matches!(class, "IllegalArgumentException" | "NumberFormatException")
            }
            _ => simple == class,
        }
    }

    /// Returns true if a condition is constantly true.
    pub(crate) fn is_always_true(condition: Option<&Expression>) -> bool {
        condition.is_none_or(|condition| {
            matches!(condition.kind, ExpressionKind::Literal(Literal::Boolean(true)))
        })
    }
}

/// Returns the value of a `catch` parameter.
fn value_of(thrown: &Rc<Thrown>) -> Value {
    match &thrown.value {
        Value::Object(object) => Value::Object(Rc::clone(object)),
        _ => Value::Exception(Rc::clone(thrown)),
    }
}
