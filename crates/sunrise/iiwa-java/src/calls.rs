//! Method calls.

use std::{rc::Rc, sync::Arc};

use crate::{
    class_id::ClassId,
    classes::simple,
    flow::Flow,
    java_lists::REMOVE_ELEMENT,
    java_state::{Activation, MAX_DEPTH},
    machine::Machine,
    place::SourceLine,
    stop::EvaluationStop,
    syntax::{ClassKind, Expression, ExpressionKind, Method, TypeName},
    type_names::unboxed,
    value::{Array, Function, JavaObject, Value},
};

impl Machine {
    /// Evaluates a call expression.
    pub(crate) fn call(
        &mut self,
        expression: &Expression,
        on: Option<&Expression>,
        name: &str,
        arguments: &[Expression],
    ) -> Result<Value, EvaluationStop> {
        let mut receiver = on.map(|on| self.evaluated(on)).transpose()?;
        if let (Some(on), Some(function @ Value::Function(_))) = (on, &receiver)
            && let Some(static_type) = self.static_type(on)
        {
            receiver = Some(self.for_variable(function.clone(), &static_type)?);
        }
        let types = self.types_of_arguments(name, arguments);
        let values = self.evaluated_all(arguments)?;
        self.place.line = expression.line;
        for value in receiver.iter().chain(&values) {
            self.refresh(value);
        }
        let place = self.place.clone();
        let (arguments, expressions) = (values, arguments);
        if let (Some(list @ Value::List(_)), "remove", [Value::Int(_)]) =
            (&receiver, name, &*arguments)
        {
            let is_element = match on {
                Some(on) if self.has_no_indices(on) => Some(true),
                _ => self.is_boxed(&expressions[0]),
            };
            let name = match is_element {
                Some(true) => REMOVE_ELEMENT,
                Some(false) => name,
                None => {
                    let unknown = self.unknown(
                        "`remove` of a list, whose argument may be an index or an element",
                    );
                    if let Value::Unknown(unknown) = &unknown {
                        self.spoil(list, unknown);
                    }
                    return Ok(unknown);
                }
            };
            return self.call_library(list, name, &arguments);
        }
        if let Some(receiver) = &receiver
            && by_equality(receiver, name, arguments.len())
            && expressions.iter().any(|expression| self.is_short(expression))
        {
            let unknown = self.unknown("a collection with numbers of type `short` or `byte`");
            if let Value::Unknown(unknown) = &unknown {
                self.spoil(receiver, unknown);
            }
            return Ok(unknown);
        }
        self.java.argument_types = types;
        let result = match (on.map(|on| &on.kind), receiver) {
            (Some(ExpressionKind::Super), Some(Value::Object(object))) => {
                self.call_above(&object, name, &arguments)
            }
            (Some(ExpressionKind::SuperOf(interface)), Some(Value::Object(object))) => {
                self.call_of_interface(interface, &object, name, &arguments)
            }
            (_, Some(Value::Object(object))) => {
                // Class methods are resolved statically, without overriding.
                let methods = self.java.classes.methods(object.class, name);
                let is_static =
                    methods.len() > 1 && methods.iter().all(|(_, method)| method.is_static);
                match on.and_then(|on| self.class_of(on)) {
                    Some(class) if is_static => {
                        self.call_on(&Value::Class(class), name, &arguments)
                    }
                    _ => self.call_on_object(&object, name, &arguments),
                }
            }
            (_, Some(receiver)) => self.call_on(&receiver, name, &arguments),
            (_, None) => self.call_by_name(name, &arguments),
        };
        self.place = place;
        self.java.argument_types = None;
        result
    }

    /// Returns true if a value is a `short` or a `byte`: as an object, it differs from integers of
    /// other types.
    fn is_short(&self, expression: &Expression) -> bool {
        let static_type = self.static_type(expression);
        static_type.is_some_and(|type_name| matches!(unboxed(&type_name), Some("short" | "byte")))
    }

    /// Returns the types of the arguments, if the method is overloaded.
    pub(crate) fn types_of_arguments(
        &self,
        name: &str,
        arguments: &[Expression],
    ) -> Option<(String, Vec<Option<TypeName>>)> {
        self.java.classes.is_overloaded(name).then(|| {
            let types = arguments.iter().map(|argument| self.static_type(argument));
            (name.to_owned(), types.collect())
        })
    }

    /// Evaluates `name(...)`: a method of this object or class, of an enclosing one, or an imported
    /// one.
    fn call_by_name(&mut self, name: &str, arguments: &[Value]) -> Result<Value, EvaluationStop> {
        let Some(activation) = self.java.activation() else {
            return self.reject(format!("the method `{name}` is not known"));
        };
        let mut this = activation.this.clone();
        let mut class = Some(activation.class);
        while let Some(id) = class {
            let start = this.as_ref().map_or(id, |object| {
                if self.java.classes.is_a(object.class, id) { object.class } else { id }
            });
            if let Some(choice) = self.method(start, name, arguments) {
                return self.run_chosen(choice, this, name, arguments);
            }
            if self.java.classes.known(id).class.kind == ClassKind::Enum
                && matches!((name, arguments), ("values", []) | ("valueOf", [_]))
            {
                return self.of_class(id, name, arguments);
            }
            if let Some(object) = this.clone() {
                if let Some(function) = object.function.clone()
                    && let Some(value) =
                        self.of_function_object(&object, &function, name, arguments)?
                {
                    return Ok(value);
                }
                if let Some(value) = self.of_object(&object, name, arguments)? {
                    return Ok(value);
                }
                let base = self.java.classes.foreign_parent(object.class).map(str::to_owned);
                if let Some(base) = base
                    && let Some(value) =
                        Rc::clone(&self.host).inherited(self, &object, &base, name, arguments)?
                {
                    return Ok(value);
                }
            }
            class = self.java.classes.known(id).outer;
            this = this.and_then(|object| match &object.outer {
                Some(Value::Object(outer)) => Some(Rc::clone(outer)),
                _ => None,
            });
        }
        let class = self.java.activation().map_or(ClassId(0), |activation| activation.class);
        for import in self.java.classes.static_imports(name, class) {
            if let Some(id) = self.java.classes.by_qualified_name(&import) {
                if let Some(choice) = self.method(id, name, arguments) {
                    return self.run_chosen(choice, None, name, arguments);
                }
            } else if let Some(value) = self.foreign_static(simple(&import), name, arguments)? {
                return Ok(value);
            }
        }
        self.opaque(
            &format!("`{name}()`, which no source of the project declares"),
            name,
            arguments,
        )
    }

    /// Calls a method of the superclass of the class that contains the call.
    fn call_above(
        &mut self,
        object: &Rc<JavaObject>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let class = self.java.activation().map_or(object.class, |activation| activation.class);
        if let Some(parent) = self.java.classes.parent(class)
            && let Some(choice) = self.method(parent, name, arguments)
        {
            return self.run_chosen(choice, Some(Rc::clone(object)), name, arguments);
        }
        if let Some(base) = self.java.classes.foreign_parent(class).map(str::to_owned)
            && let Some(value) =
                Rc::clone(&self.host).inherited(self, object, &base, name, arguments)?
        {
            return Ok(value);
        }
        match self.of_object(object, name, arguments)? {
            Some(value) => Ok(value),
            // Methods of KUKA classes such as `super.initialize()` and `super.dispose()` do not
            // affect the plan.
            None => Ok(Value::Null),
        }
    }

    /// Evaluates `Interface.super.name(...)`, a default method of an interface.
    fn call_of_interface(
        &mut self,
        interface: &TypeName,
        object: &Rc<JavaObject>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let class = self
            .class_named(&interface.name)
            .filter(|id| self.java.classes.known(*id).class.kind == ClassKind::Interface);
        match class.and_then(|id| self.method(id, name, arguments)) {
            Some(choice) => self.run_chosen(choice, Some(Rc::clone(object)), name, arguments),
            None => self.opaque(
                &format!("`{}.super.{name}`, of a class around or a library", interface.name),
                name,
                arguments,
            ),
        }
    }

    /// Evaluates `receiver.name(...)`.
    pub(crate) fn call_on(
        &mut self,
        receiver: &Value,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match receiver {
            Value::Object(object) => self.call_on_object(object, name, arguments),
            Value::Class(id) => {
                if let Some(choice) = self.method(*id, name, arguments) {
                    return self.run_chosen(choice, None, name, arguments);
                }
                self.of_class(*id, name, arguments)
            }
            Value::ForeignClass(class) => {
                let class = Rc::clone(class);
                match self.foreign_static(&class, name, arguments)? {
                    Some(value) => Ok(value),
                    None => self.opaque(
                        &format!("the result of `{class}.{name}`, of a library without source"),
                        name,
                        arguments,
                    ),
                }
            }
            Value::Host(value) => {
                let (host, value) = (Rc::clone(&self.host), Rc::clone(value));
                let result = host.call(self, &value, name, arguments)?;
                if result.unknown().is_some_and(|unknown| unknown.is_unmodelled_call) {
                    self.after_unmodelled(None, name, arguments, &result)?;
                }
                Ok(result)
            }
            Value::Unknown(unknown) => {
                if self.host.acting_on_receivers().contains(&name) {
                    let unknown = Rc::clone(unknown);
                    return self.reject_unknown(&format!("what `{name}` is called on"), &unknown);
                }
                self.may_act_with(name, arguments);
                self.after_unmodelled(None, name, arguments, receiver)?;
                Ok(receiver.clone())
            }
            Value::Null => {
                self.throw("NullPointerException", format!("`{name}` is called on null"))
            }
            Value::Function(function) => {
                let function = Rc::clone(function);
                self.call_on_function(&function, name, arguments)
            }
            _ => self.call_library(receiver, name, arguments),
        }
    }

    /// Calls a method of a project object.
    pub(crate) fn call_on_object(
        &mut self,
        object: &Rc<JavaObject>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        if let Some(choice) = self.method(object.class, name, arguments)
            && choice.has_body()
        {
            return self.run_chosen(choice, Some(Rc::clone(object)), name, arguments);
        }
        if let Some(function) = object.function.clone()
            && let Some(value) = self.of_function_object(object, &function, name, arguments)?
        {
            return Ok(value);
        }
        if let Some(value) = self.of_object(object, name, arguments)? {
            return Ok(value);
        }
        let base = self.java.classes.foreign_parent(object.class).map(str::to_owned);
        if let Some(base) = &base
            && let Some(value) =
                Rc::clone(&self.host).inherited(self, object, base, name, arguments)?
        {
            return Ok(value);
        }
        let class = self.java.classes.known(object.class).class.name.clone();
        self.opaque(
            &format!("the result of `{class}.{name}`, which no source of the project declares"),
            name,
            arguments,
        )
    }

    /// Calls a method that all objects, constants or exceptions have.
    fn of_object(
        &mut self,
        object: &Rc<JavaObject>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let this = Value::Object(Rc::clone(object));
        Ok(Some(match (name, arguments) {
            ("getClass", []) => Value::Class(object.class),
            ("equals", [other]) => match other {
                Value::Unknown(_) => other.clone(),
                _ => match self.are_equal_records(&this, other)? {
                    Ok(is_equal) => Value::Boolean(is_equal),
                    Err(unknown) => Value::Unknown(unknown),
                },
            },
            ("toString" | "name", []) if object.constant.is_some() => {
                let name = object.constant.as_ref().map_or("", |(name, _)| name);
                Value::text(name)
            }
            ("toString", [])
                if self.java.classes.known(object.class).class.kind == ClassKind::Record =>
            {
                self.text_of_record(object, 0)?.map_or_else(Value::Unknown, Value::text)
            }
            ("toString", []) => self.unknown("the text of an object without `toString`"),
            ("ordinal", []) if object.constant.is_some() => {
                Value::Int(object.constant.as_ref().map_or(0, |(_, ordinal)| *ordinal))
            }
            // The class of a constant may be its own body.
            ("getDeclaringClass", []) if object.constant.is_some() => {
                Value::Class(self.java.classes.parent(object.class).unwrap_or(object.class))
            }
            ("compareTo", [Value::Object(other)]) => match (&object.constant, &other.constant) {
                (Some((_, ordinal)), Some((_, other))) => Value::Int(ordinal - other),
                _ => return Ok(None),
            },
            ("hashCode", []) => self.unknown("a hash code"),
            ("getMessage" | "getLocalizedMessage", []) => {
                let message = object.message.borrow().clone();
                return Ok(message);
            }
            ("printStackTrace" | "notify" | "notifyAll", _) => Value::Null,
            _ => return Ok(None),
        }))
    }

    /// Calls a method of a class itself.
    fn of_class(
        &mut self,
        id: ClassId,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let class = Arc::clone(&self.java.classes.known(id).class);
        match (name, arguments) {
            ("values", []) if class.kind == ClassKind::Enum => {
                self.initialize(id)?;
                let constants = self.java.constants.get(&id).cloned().unwrap_or_default();
                Ok(Value::array(&class.name, constants))
            }
            ("valueOf", [Value::Text(text)]) => match self.static_field(id, text)? {
                Some(value) => Ok(value),
                None => self.throw(
                    "IllegalArgumentException",
                    format!("the enum {} has no constant {text}", class.name),
                ),
            },
            ("getSimpleName", []) => Ok(Value::text(&class.name)),
            ("getName" | "getCanonicalName", []) => {
                let package = self.java.classes.package(id);
                let dot = if package.is_empty() { "" } else { "." };
                Ok(Value::text(format!("{package}{dot}{}", class.name)))
            }
            ("isInstance", [Value::Object(object)]) => {
                Ok(Value::Boolean(self.java.classes.is_a(object.class, id)))
            }
            _ => {
                if let Some(base) = self.java.classes.foreign_parent(id).map(str::to_owned)
                    && let Some(value) = self.foreign_static(&base, name, arguments)?
                {
                    return Ok(value);
                }
                self.opaque(
                    &format!("the result of `{}.{name}`, which no source declares", class.name),
                    name,
                    arguments,
                )
            }
        }
    }

    /// Calls a method of a value that is not modelled.
    fn opaque(
        &mut self,
        subject: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        if self.host.acting_on_receivers().contains(&name) {
            return self.reject(format!("the motion depends on {subject}"));
        }
        self.may_act_with(name, arguments);
        let result = self.unknown(subject);
        self.after_unmodelled(None, name, arguments, &result)?;
        Ok(result)
    }

    /// Notes that code without source receives a value that can act.
    pub(crate) fn may_act_with(&mut self, name: &str, arguments: &[Value]) {
        let may_act = |value: &Value| matches!(value, Value::Host(host) if host.can_act());
        if arguments.iter().any(may_act) {
            self.note(format!(
                "`{name}` gets what can act, and its source is not in the project: what it does \
                 with it is left out"
            ));
        }
    }

    /// Runs a method.
    pub(crate) fn run(
        &mut self,
        owner: ClassId,
        this: Option<Rc<JavaObject>>,
        method: &Arc<Method>,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        if method.is_static {
            self.initialize(owner)?;
        }
        let function = this.as_ref().and_then(|this| this.function.clone());
        if let (None, Some(function)) = (&method.body, function) {
            return self.run_as_method(owner, method, &function, arguments);
        }
        let Some(body) = &method.body else {
            let class = self.java.classes.known(owner).class.name.clone();
            return self.opaque(
                &format!("the result of `{class}.{}`, which has no body", method.name),
                &method.name,
                arguments,
            );
        };
        let from = self.enter(owner, this, method, arguments)?;
        let result = self.block(body).and_then(|flow| match flow {
            Flow::Return(value) => self.for_variable(value, &method.returns),
            _ => Ok(Value::Null),
        });
        self.leave(from, &result);
        result
    }

    /// Runs a function as the abstract method of a project interface.
    fn run_as_method(
        &mut self,
        owner: ClassId,
        method: &Arc<Method>,
        function: &Rc<Function>,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let from = self.enter(owner, None, method, arguments)?;
        let locals = self.java.activation().map_or(&[][..], |activation| &activation.locals);
        let arguments: Vec<_> = locals.iter().map(|local| local.value.clone()).collect();
        self.leave(from, &Ok(()));
        let types = method.parameters.iter().map(|parameter| {
            let erased = self.erased_parameter(owner, method, &parameter.type_name);
            (erased == parameter.type_name).then_some(erased)
        });
        let types: Vec<_> = types.collect();
        let result = self.run_function(function, &arguments, &types)?;
        if let Value::Function(function) = &result {
            return Ok(self.as_interface(function, &method.returns, owner));
        }
        self.for_result(result, &method.returns)
    }

    /// Begins a method: declares its parameters as local variables.
    pub(crate) fn enter(
        &mut self,
        owner: ClassId,
        this: Option<Rc<JavaObject>>,
        method: &Method,
        arguments: &[Value],
    ) -> Result<SourceLine, EvaluationStop> {
        let from = self.activate(owner, this, &method.name, method.line)?;
        self.java.argument_types = None;
        if let (false, Some(activation)) =
            (method.type_parameters.is_empty(), self.java.activations.last_mut())
        {
            activation.type_parameters.clone_from(&method.type_parameters);
        }
        let mut arguments = arguments.to_vec();
        if method.is_variadic
            && let Some(fixed) = method.parameters.len().checked_sub(1)
            && let Some(last) = method.parameters.get(fixed)
        {
            let is_array = arguments.len() == method.parameters.len()
                && self.fits(owner, &arguments[fixed], &last.type_name).is_some()
                && !matches!(arguments[fixed], Value::Unknown(_));
            if !is_array && arguments.len() >= fixed {
                let element = last.type_name.element();
                let others = arguments.split_off(fixed);
                let others: Vec<_> =
                    others.into_iter().map(|value| value.converted_to(&element)).collect();
                let values = std::cell::RefCell::new(others);
                arguments.push(Value::Array(Rc::new(Array { element, values })));
            }
        }
        for (parameter, value) in method.parameters.iter().zip(arguments) {
            let value = self.for_variable(value, &parameter.type_name)?;
            self.java.declare(&parameter.name, Some(&parameter.type_name), value);
        }
        Ok(from)
    }

    /// Activates a class, and `method` in it if not empty. Returns the previous place.
    pub(crate) fn activate(
        &mut self,
        class: ClassId,
        this: Option<Rc<JavaObject>>,
        method: &str,
        line: u32,
    ) -> Result<SourceLine, EvaluationStop> {
        if self.java.activations.len() >= MAX_DEPTH {
            return self.reject(format!(
                "`{method}` is called more than {MAX_DEPTH} calls deep: a recursion may have no end"
            ));
        }
        let from = self.place.clone();
        self.java.activations.push(Activation {
            class,
            from: from.clone(),
            this,
            locals: Vec::new(),
            method: method.to_owned(),
            outside_loop: 0,
            lambda: None,
            type_parameters: Vec::new(),
        });
        self.place = SourceLine { file: Rc::clone(&self.java.classes.known(class).file), line };
        Ok(from)
    }

    /// Ends an activation, and returns to the place `from`. On an error, the current place is kept.
    pub(crate) fn leave<T>(&mut self, from: SourceLine, result: &Result<T, EvaluationStop>) {
        self.java.activations.pop();
        if result.is_ok() {
            self.place = from;
        }
    }
}

/// Returns true if a method of a collection compares its arguments with elements or keys, or adds
/// them.
fn by_equality(receiver: &Value, name: &str, arguments: usize) -> bool {
    match receiver {
        Value::Map(_) => arguments > 0,
        Value::List(_) => match name {
            "contains" | "indexOf" | "lastIndexOf" | "search" | "push" | "offer" => true,
            "add" => arguments == 1,
            _ => false,
        },
        _ => false,
    }
}
