//! Static search for the effects of code: code that depends on an unknown value may be skipped only
//! if it does not act.

use std::rc::Rc;

use crate::{
    effects::{Action, Effects},
    function::{FunctionSyntax, KnownFunction},
    interfaces::{may_run, runs_any},
    machine::Machine,
    syntax::{
        Class, Expression, ExpressionKind, Label, Member, Reference, ReferenceTarget, Statement,
        StatementKind, SwitchGroup,
    },
    value::{FunctionCode, Value},
};

/// Prefixes of method names that change their receiver.
const CHANGING: [&str; 25] = [
    "add",
    "put",
    "remove",
    "clear",
    "set",
    "push",
    "pop",
    "append",
    "insert",
    "delete",
    "reverse",
    "replace",
    "sort",
    "retain",
    "poll",
    "offer",
    "next",
    "previous",
    "increment",
    "decrement",
    "getAnd",
    "compute",
    "merge",
    "accumulate",
    "transform",
];

/// Library classes whose methods change their arguments.
const CHANGING_ARGUMENTS: [&str; 3] = ["Collections", "Arrays", "System"];

/// Search state and the effects found.
struct EffectSearch<'m> {
    machine: &'m mut Machine,
    effects: Effects,
    /// Number of enclosing loops, and of enclosing loops and switches, within the searched code.
    loops: usize,
    breakable: usize,
    /// Variables that alias the contents of others.
    aliases: Vec<(String, String)>,
}

impl Machine {
    /// Returns the effects of statements.
    pub(crate) fn effects_of<'s>(
        &mut self,
        statements: impl IntoIterator<Item = &'s Statement>,
    ) -> Effects {
        let mut search = EffectSearch::new(self);
        for statement in statements {
            search.statement(statement);
        }
        search.finish()
    }

    /// Returns the effects of an expression.
    pub(crate) fn effects_of_expression(&mut self, expression: &Expression) -> Effects {
        let mut search = EffectSearch::new(self);
        search.expression(expression);
        search.finish()
    }

    /// Returns the effects of all project methods and constructors of this name.
    pub(crate) fn effects_of_method(&mut self, name: &str) -> Effects {
        if let Some(known) = self.java.effects.get(name) {
            return known.clone();
        }
        // In a recursion, a second visit finds no new effects.
        self.java.effects.insert(name.to_owned(), Effects::default());
        let mut effects = Effects::default();
        for method in self.java.classes.named_methods(name).to_vec() {
            if let Some(body) = &method.body {
                let body_effects = self.effects_of(body);
                effects.add(&body_effects);
                effects.returns.extend(body_effects.returns);
            }
        }
        (effects.leaves, effects.continues) = (false, false);
        self.java.effects.insert(name.to_owned(), effects.clone());
        effects
    }
}

impl Machine {
    /// Returns the effects of the functions that a call of this method with this number of
    /// arguments may run.
    fn effects_of_functions(&mut self, name: &str, arguments: usize) -> Effects {
        let key = format!("{name}/{arguments}");
        if let Some(known) = self.java.effects.get(&key) {
            return known.clone();
        }
        self.java.effects.insert(key.clone(), Effects::default());
        let mut effects = Effects::default();
        for function in self.functions_behind(name, arguments) {
            effects.add(&self.effects_of_syntax(&function));
        }
        self.java.effects.insert(key, effects.clone());
        effects
    }

    /// Returns the functions that a call may run.
    fn functions_behind(&self, name: &str, arguments: usize) -> Vec<FunctionSyntax> {
        let methods = self.java.classes.named_methods(name);
        let is_abstract = methods
            .iter()
            .any(|method| method.body.is_none() && method.parameters.len() == arguments);
        let functions = self.java.functions.values();
        let is_behind = |known_function: &&KnownFunction| {
            let parameters = match &known_function.syntax {
                FunctionSyntax::Lambda(lambda) => Some(lambda.parameters.len()),
                FunctionSyntax::Reference(_) => None,
            };
            let methods = known_function.methods.borrow();
            let is_it = methods.is_empty() || methods.contains(name);
            runs_any(name, arguments)
                || is_it && (is_abstract || may_run(name, arguments, parameters))
        };
        functions.filter(is_behind).map(|function| function.syntax.clone()).collect()
    }

    fn effects_of_syntax(&mut self, function: &FunctionSyntax) -> Effects {
        let mut search = EffectSearch::new(self);
        match function {
            FunctionSyntax::Lambda(lambda) => search.statements(&lambda.body),
            FunctionSyntax::Reference(reference) => search.reference(reference),
        }
        let mut effects = search.finish();
        (effects.leaves, effects.continues) = (false, false);
        effects
    }

    /// Returns the effects of a function, or of this method of an object.
    pub(crate) fn effects_of_function(&mut self, function: &Value, method: &str) -> Effects {
        let function = match function {
            Value::Function(function) => Rc::clone(function),
            Value::Object(object) => match &object.function {
                Some(function) => Rc::clone(function),
                None => return self.effects_of_method(method),
            },
            _ => return Effects::default(),
        };
        if let Some(syntax) = function.syntax() {
            return self.effects_of_syntax(&syntax);
        }
        let mut effects = Effects::default();
        if let FunctionCode::Combined(combined) = &function.code {
            for part in combined.parts() {
                effects.add(&self.effects_of_function(part, method));
            }
        }
        effects
    }

    /// Reduces effects to those that outlive a method: assignments to its local variables do not.
    pub(crate) fn outliving(&self, effects: Effects) -> Effects {
        let mut effects = effects;
        if !effects.assigns.is_empty() {
            let fields = self.field_names();
            effects.assigns.retain(|name| fields.contains(name));
        }
        effects
    }
}

impl<'m> EffectSearch<'m> {
    fn new(machine: &'m mut Machine) -> Self {
        let effects = Effects::default();
        Self { machine, effects, loops: 0, breakable: 0, aliases: Vec::new() }
    }

    /// Returns the effects found. A change of a variable's contents also changes its aliases.
    fn finish(self) -> Effects {
        let mut effects = self.effects;
        for (alias, source) in self.aliases.iter().rev() {
            if effects.changes.contains(alias) {
                effects.changes.insert(source.clone());
            }
        }
        effects
    }

    fn alias(&mut self, name: &str, value: &Expression) {
        if let Some(source) = base_name(value) {
            self.aliases.push((name.to_owned(), source.to_owned()));
        }
    }

    /// Returns the names of variables that an expression may return.
    fn sources(&mut self, expression: &Expression) -> Vec<String> {
        match &expression.kind {
            ExpressionKind::Call { name, .. } => {
                let returns = self.machine.effects_of_method(name).returns;
                returns.into_iter().chain(base_name(expression).map(str::to_owned)).collect()
            }
            _ => base_name(expression).map(str::to_owned).into_iter().collect(),
        }
    }

    fn statements(&mut self, statements: &[Statement]) {
        for statement in statements {
            self.statement(statement);
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::Block(body) | StatementKind::Synchronized { body } => {
                self.statements(body);
            }
            StatementKind::Local { variables, .. } => {
                for variable in variables {
                    if let Some(value) = &variable.initial {
                        self.expression(value);
                        self.alias(&variable.name, value);
                    }
                }
            }
            StatementKind::Expression(value) | StatementKind::Yield(value) => {
                self.expression(value);
            }
            StatementKind::If { condition, then_branch, otherwise } => {
                self.expression(condition);
                self.statement(then_branch);
                if let Some(statement) = otherwise {
                    self.statement(statement);
                }
            }
            StatementKind::While { condition, body }
            | StatementKind::DoWhile { body, condition } => {
                self.expression(condition);
                self.in_loop(body);
            }
            StatementKind::For { initial, condition, update, body } => {
                self.statements(initial);
                condition.iter().chain(update).for_each(|part| self.expression(part));
                self.in_loop(body);
            }
            StatementKind::ForEach { iterable, body, .. } => {
                self.expression(iterable);
                self.in_loop(body);
            }
            StatementKind::Switch { value, groups } => self.switch(value, groups),
            StatementKind::Break(label) => {
                self.effects.leaves |= label.is_some() || self.loops + self.breakable == 0;
            }
            StatementKind::Continue(label) => {
                self.effects.leaves |= label.is_some();
                self.effects.continues |= self.loops == 0;
            }
            StatementKind::Return(value) => {
                if let Some(value) = value {
                    self.expression(value);
                    self.effects.returns.extend(base_name(value).map(str::to_owned));
                }
                self.effects.leaves = true;
            }
            StatementKind::Throw(value) => {
                self.expression(value);
                self.effects.leaves = true;
            }
            StatementKind::Try { resources, body, catches, finally } => {
                self.statements(resources);
                self.statements(body);
                for catch in catches {
                    self.statements(&catch.body);
                }
                if let Some(block) = finally {
                    self.statements(block);
                }
            }
            StatementKind::Labelled { body, .. } => self.statement(body),
            StatementKind::LocalClass(class) => self.methods(class),
            StatementKind::Assert | StatementKind::Empty | StatementKind::Unsupported(_) => {}
        }
    }

    fn switch(&mut self, value: &Expression, groups: &[SwitchGroup]) {
        self.expression(value);
        self.breakable += 1;
        for group in groups {
            for label in &group.labels {
                if let Label::Value(value) = label {
                    self.expression(value);
                }
            }
            group.guard.iter().for_each(|guard| self.expression(guard));
            self.statements(&group.body);
        }
        self.breakable -= 1;
    }

    fn in_loop(&mut self, body: &Statement) {
        self.loops += 1;
        self.statement(body);
        self.loops -= 1;
    }

    fn expressions(&mut self, expressions: &[Expression]) {
        for expression in expressions {
            self.expression(expression);
        }
    }

    fn expression(&mut self, expression: &Expression) {
        match &expression.kind {
            ExpressionKind::Call { on, name, arguments } => {
                if let Some(on) = on {
                    self.expression(on);
                    if CHANGING.iter().any(|beginning| name.starts_with(beginning)) {
                        let sources = self.sources(on);
                        self.effects.changes.extend(sources);
                    }
                }
                self.expressions(arguments);
                let changes = self.called(name, arguments.len());
                let on = on.as_deref().and_then(base_name);
                if changes || on.is_some_and(|class| CHANGING_ARGUMENTS.contains(&class)) {
                    for argument in arguments {
                        let sources = self.sources(argument);
                        self.effects.changes.extend(sources);
                    }
                }
            }
            ExpressionKind::New { type_name, arguments, body } => {
                self.expressions(arguments);
                self.called(crate::classes::simple(&type_name.name), arguments.len());
                if let Some(class) = body {
                    self.initializers(class);
                    self.methods(class);
                }
            }
            ExpressionKind::Assign { target, value, .. } => {
                self.expression(value);
                if let ExpressionKind::Name(name) = &target.kind {
                    self.alias(name, value);
                }
                self.assigned(target);
            }
            ExpressionKind::Step { target, .. } => self.assigned(target),
            ExpressionKind::Field { object, .. } => self.expression(object),
            ExpressionKind::ThisCall(values)
            | ExpressionKind::SuperCall(values)
            | ExpressionKind::Array(values) => self.expressions(values),
            ExpressionKind::NewArray { lengths, values, .. } => {
                self.expressions(lengths);
                if let Some(expressions) = values {
                    self.expressions(expressions);
                }
            }
            ExpressionKind::Index { array, index } => {
                self.expression(array);
                self.expression(index);
            }
            ExpressionKind::Unary { value, .. }
            | ExpressionKind::Cast { value, .. }
            | ExpressionKind::InstanceOf { value, .. } => self.expression(value),
            ExpressionKind::Binary { left, right, .. } => {
                self.expression(left);
                self.expression(right);
            }
            ExpressionKind::Conditional { condition, then_value, otherwise } => {
                self.expression(condition);
                self.expression(then_value);
                self.expression(otherwise);
            }
            ExpressionKind::Switch { value, groups } => self.switch(value, groups),
            ExpressionKind::Lambda(lambda) => self.aside(&lambda.body),
            ExpressionKind::Reference(reference) => self.reference(reference),
            ExpressionKind::Literal(_)
            | ExpressionKind::Name(_)
            | ExpressionKind::This
            | ExpressionKind::Super
            | ExpressionKind::SuperOf(_)
            | ExpressionKind::ClassLiteral(_)
            | ExpressionKind::Unsupported(_) => {}
        }
    }

    /// Searches code that runs later or never: its jumps do not leave the surrounding code.
    fn aside(&mut self, body: &[Statement]) {
        let (leaves, continues) = (self.effects.leaves, self.effects.continues);
        self.statements(body);
        (self.effects.leaves, self.effects.continues) = (leaves, continues);
    }

    /// Searches the methods of a class within a method, which later code may call.
    fn methods(&mut self, class: &Class) {
        for body in class.methods.iter().filter_map(|method| method.body.as_ref()) {
            self.aside(body);
        }
    }

    fn reference(&mut self, reference: &Reference) {
        match (&reference.target, &reference.name) {
            (ReferenceTarget::Expression(expression), _) => self.expression(expression),
            (ReferenceTarget::Type(type_name), None) => {
                self.called(crate::classes::simple(&type_name.name), 0);
            }
            (ReferenceTarget::Type(_), Some(_)) => {}
        }
        if let Some(name) = &reference.name {
            for arguments in 0..=2 {
                self.called(name, arguments);
            }
            if let ReferenceTarget::Expression(expression) = &reference.target
                && CHANGING.iter().any(|beginning| name.starts_with(beginning))
            {
                let sources = self.sources(expression);
                self.effects.changes.extend(sources);
            }
        }
    }

    fn initializers(&mut self, class: &Class) {
        for member in &class.members {
            match member {
                Member::Field(field) => {
                    field.initial.iter().for_each(|value| self.expression(value));
                }
                Member::Initializer { body, .. } => self.statements(body),
            }
        }
    }

    /// Adds a call of a project method, if one has this name. Returns true if the call may change
    /// contents, possibly of its arguments.
    fn called(&mut self, name: &str, arguments: usize) -> bool {
        self.effects.calls.insert(name.to_owned());
        if self.machine.host.acting().contains(&name) {
            let is_pause = self.machine.host.pausing().contains(&name);
            let action = if is_pause { Action::Pause } else { Action::Motion };
            self.effects.action = self.effects.action.max(action);
            return false;
        }
        let mut effects = self.machine.effects_of_method(name);
        effects.add(&self.machine.effects_of_functions(name, arguments));
        self.effects.add(&effects);
        !effects.changes.is_empty()
    }

    fn assigned(&mut self, target: &Expression) {
        match &target.kind {
            ExpressionKind::Name(name) => {
                self.effects.assigns.insert(name.clone());
            }
            ExpressionKind::Field { object, name } => {
                self.expression(object);
                self.effects.assigns.insert(name.clone());
            }
            ExpressionKind::Index { array, index } => {
                self.expression(index);
                self.effects.changes.extend(base_name(array).map(str::to_owned));
            }
            _ => self.expression(target),
        }
    }
}

/// Returns the variable or field at the base of an access path.
fn base_name(expression: &Expression) -> Option<&str> {
    match &expression.kind {
        ExpressionKind::Name(name) | ExpressionKind::Field { name, .. } => Some(name),
        ExpressionKind::Index { array, .. } => base_name(array),
        ExpressionKind::Call { on: Some(on), .. } => base_name(on),
        _ => None,
    }
}
