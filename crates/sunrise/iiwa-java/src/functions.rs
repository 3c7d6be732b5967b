//! Evaluation and calls of lambda expressions and method references (JLS 15.13, 15.27).
//!
//! The interface of a function is unknown until a variable, a parameter or a call determines it. A
//! function with a project interface is a [`JavaObject`], with the interface's default methods;
//! with a Java library interface it remains a [`Function`].

use std::{
    cell::{OnceCell, RefCell},
    collections::{HashMap, hash_map::Entry},
    rc::Rc,
    sync::Arc,
};

use crate::{
    class_id::ClassId,
    classes::simple,
    function::KnownFunction,
    interfaces::{Interface, interface},
    java_lists::REMOVE_ELEMENT,
    library_calls::class_of_value,
    machine::Machine,
    stop::EvaluationStop,
    syntax::{
        ClassKind, Expression, ExpressionKind, Lambda, Method, Reference, ReferenceTarget, TypeName,
    },
    type_names::is_primitive,
    value::{Function, FunctionCode, JavaObject, Local, Value},
};

/// Maximum depth of composed functions: running them takes stack for each level.
const MAX_LEVELS: usize = 1000;

impl Machine {
    /// Evaluates a lambda expression.
    pub(crate) fn lambda(&mut self, lambda: &Arc<Lambda>) -> Value {
        let code = FunctionCode::Lambda(Arc::clone(lambda));
        self.new_function(lambda.line, code)
    }

    /// Evaluates a method reference.
    pub(crate) fn reference(
        &mut self,
        reference: &Arc<Reference>,
    ) -> Result<Value, EvaluationStop> {
        let receiver = match &reference.target {
            ReferenceTarget::Type(_) => None,
            ReferenceTarget::Expression(expression) => match self.evaluated(expression)? {
                Value::Class(_) | Value::ForeignClass(_) if !is_print_stream(expression) => None,
                Value::Null => {
                    return self.throw("NullPointerException", "a method reference to null");
                }
                receiver => Some(receiver),
            },
        };
        self.place.line = reference.line;
        let code = FunctionCode::Reference(Arc::clone(reference), receiver);
        Ok(self.new_function(reference.line, code))
    }

    pub(crate) fn new_function(&mut self, line: u32, code: FunctionCode) -> Value {
        let activation = self.java.activation();
        let class = activation.map_or(ClassId(0), |activation| activation.class);
        let this = activation.and_then(|activation| activation.this.clone());
        let names = match &code {
            FunctionCode::Lambda(lambda) => &lambda.names[..],
            FunctionCode::Reference(reference, _) => &reference.names,
            FunctionCode::Combined(_) => &[],
        };
        let locals = activation.map_or(&[][..], |activation| &activation.locals).iter();
        let is_named = |local: &&Local| names.binary_search(&local.name).is_ok();
        // A class of the method captures all enclosing variables.
        let has_class =
            locals.clone().filter(is_named).any(|local| matches!(local.value, Value::Class(_)));
        let locals = locals.filter(|local| has_class || is_named(local)).cloned().collect();
        let depth = match &code {
            FunctionCode::Combined(combined) => {
                1 + combined.parts().into_iter().map(depth).max().unwrap_or(0)
            }
            _ => 0,
        };
        if depth > MAX_LEVELS {
            return self.unknown("a function of more than 1000 levels of functions");
        }
        let interface = OnceCell::new();
        let function = Function { class, this, locals, line, code, depth, interface };
        if let Some(syntax) = function.syntax() {
            let known = KnownFunction { methods: RefCell::default(), syntax };
            let address = known.syntax.address();
            if let Entry::Vacant(place) = self.java.functions.entry(address) {
                place.insert(known);
                // The new function may add effects to calls that were analysed before.
                self.java.effects.clear();
            }
        }
        Value::Function(Rc::new(function))
    }

    /// Converts a function to a variable of this type.
    pub(crate) fn as_interface(
        &self,
        function: &Rc<Function>,
        wanted: &TypeName,
        within: ClassId,
    ) -> Value {
        let same = Value::Function(Rc::clone(function));
        if wanted.dimensions > 0 {
            return same;
        }
        if let Some(class) = self.java.classes.find(&wanted.name, within) {
            if self.java.classes.known(class).class.kind != ClassKind::Interface {
                return same;
            }
            let method_name = self.abstract_method(class).map(|(_, method)| method.name.clone());
            let foreign =
                || self.foreign_interface(class).map(|interface| interface.method.to_owned());
            if let Some(method) = method_name.or_else(foreign) {
                self.implements(function, &method);
            }
            return Value::Object(Rc::new(JavaObject {
                class,
                fields: RefCell::default(),
                outer: None,
                captured: HashMap::new(),
                constant: None,
                inherited: RefCell::default(),
                message: RefCell::default(),
                function: Some(Rc::clone(function)),
            }));
        }
        if let Some(interface) = interface(simple(&wanted.name)) {
            self.implements(function, interface.method);
            // The first interface is kept, because the object is shared.
            _ = function.interface.set(wanted.clone());
        }
        same
    }

    /// Records the method by which calls run a function.
    fn implements(&self, function: &Function, method: &str) {
        let known = function.syntax().and_then(|syntax| self.java.functions.get(&syntax.address()));
        if let Some(known) = known {
            known.methods.borrow_mut().insert(method.to_owned());
        }
    }

    /// Returns the abstract method of a project interface; `None` unless it has exactly one.
    pub(crate) fn abstract_method(&self, id: ClassId) -> Option<(ClassId, Arc<Method>)> {
        let classes = &self.java.classes;
        let parents = classes.with_parents(id);
        let methods_of = |class: &ClassId| {
            let class = *class;
            classes.known(class).class.methods.iter().map(move |method| (class, Arc::clone(method)))
        };
        let all: Vec<_> = parents.iter().flat_map(methods_of).collect();
        let is_implemented = |place: usize, method: &Method| {
            let nearer = all[..place].iter();
            nearer.clone().any(|(_, other)| {
                other.name == method.name && other.parameters.len() == method.parameters.len()
            })
        };
        let mut unimplemented = None;
        for (place, (class, method)) in all.iter().enumerate() {
            let is_of_object = matches!(
                (method.name.as_str(), method.parameters.len()),
                ("equals", 1) | ("hashCode" | "toString", 0)
            );
            if method.body.is_some() || is_of_object || is_implemented(place, method) {
                continue;
            }
            if unimplemented.is_some() {
                return None;
            }
            unimplemented = Some((*class, Arc::clone(method)));
        }
        unimplemented
    }

    /// Returns the Java library interface that a project interface extends.
    pub(crate) fn foreign_interface(&self, id: ClassId) -> Option<&'static Interface> {
        let classes = &self.java.classes;
        let parents = classes.with_parents(id).into_iter();
        let mut above = parents.flat_map(|id| &classes.known(id).class.implements);
        above.find_map(|type_name| interface(simple(&type_name.name)))
    }

    /// Runs a function through this Java library interface; the value is null if the interface
    /// method returns nothing.
    pub(crate) fn apply(
        &mut self,
        function: &Value,
        as_interface: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let Some(interface) = interface(as_interface) else {
            return self.reject(format!("the interface {as_interface} is not known"));
        };
        let arguments = self.as_parameters(interface, arguments)?;
        let name = interface.method;
        self.count_step()?;
        self.java.argument_types = self
            .java
            .classes
            .is_overloaded(name)
            .then(|| (name.to_owned(), vec![None; arguments.len()]));
        let result = match function {
            Value::Function(function) => {
                _ = function.interface.set(TypeName::new(as_interface, 0));
                self.implements(function, name);
                let types = interface
                    .parameters
                    .iter()
                    .map(|parameter| Interface::resolved(parameter, &[]));
                let types: Vec<_> = types.collect();
                self.run_function(function, &arguments, &types)?
            }
            Value::Object(object) => self.call_on_object(object, name, &arguments)?,
            other => self.call_on(other, name, &arguments)?,
        };
        self.java.argument_types = None;
        self.for_result(result, &TypeName::new(interface.returns, 0))
    }

    fn as_parameters(
        &self,
        interface: &Interface,
        arguments: &[Value],
    ) -> Result<Vec<Value>, EvaluationStop> {
        let pairs = arguments.iter().zip(interface.parameters);
        pairs
            .map(|(value, type_name)| {
                self.for_variable(value.clone(), &TypeName::new(type_name, 0))
            })
            .collect()
    }

    /// Calls a method of a function without a project interface.
    pub(crate) fn call_on_function(
        &mut self,
        function: &Rc<Function>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let Some(interface_type) = function.interface.get().cloned() else {
            // These methods have no argument or result whose type is needed.
            if arguments.is_empty() && matches!(name, "run" | "call" | "get") {
                return self.run_function(function, arguments, &[]);
            }
            let value = self
                .unknown(format!("`{name}` of {}, whose interface is not known", function.kind()));
            self.after_unmodelled(
                Some(&Value::Function(Rc::clone(function))),
                name,
                arguments,
                &value,
            )?;
            return Ok(value);
        };
        let Some(interface) = interface(simple(&interface_type.name)) else {
            return self.reject(format!("the interface {} is not known", interface_type.name));
        };
        if interface.method == name && interface.parameters.len() == arguments.len() {
            let arguments = self.as_parameters(interface, arguments)?;
            let types = interface.parameters.iter();
            let types: Vec<_> = types
                .map(|type_name| Interface::resolved(type_name, &interface_type.arguments))
                .collect();
            let result = self.run_function(function, &arguments, &types)?;
            return match Interface::resolved(interface.returns, &interface_type.arguments) {
                Some(returns) => self.for_result(result, &returns),
                None => Ok(result),
            };
        }
        let this = Value::Function(Rc::clone(function));
        match self.combined(&this, interface, name, arguments)? {
            Some(value) => Ok(value),
            None => match (name, arguments) {
                ("equals", [other]) => Ok(Value::Boolean(this.is_same(other))),
                ("hashCode" | "toString" | "getClass", []) => {
                    Ok(self.unknown(format!("`{name}` of {}", function.kind())))
                }
                _ => self.unmodelled(&this, name, arguments),
            },
        }
    }

    /// Calls an abstract method of a function with a project interface; `None` if it is not the
    /// interface's method.
    pub(crate) fn of_function_object(
        &mut self,
        object: &Rc<JavaObject>,
        function: &Rc<Function>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        if let Some((owner, method)) = self.abstract_method(object.class)
            && method.name == name
            && method.parameters.len() == arguments.len()
        {
            return self.run(owner, Some(Rc::clone(object)), &method, arguments).map(Some);
        }
        let Some(interface) = self.foreign_interface(object.class) else { return Ok(None) };
        if interface.method == name && interface.parameters.len() == arguments.len() {
            let arguments = self.as_parameters(interface, arguments)?;
            let result = self.run_function(function, &arguments, &[])?;
            return self.for_result(result, &TypeName::new(interface.returns, 0)).map(Some);
        }
        self.combined(&Value::Object(Rc::clone(object)), interface, name, arguments)
    }

    /// Runs a function; `types` are the parameter types, as far as the interface states them.
    pub(crate) fn run_function(
        &mut self,
        function: &Rc<Function>,
        arguments: &[Value],
        types: &[Option<TypeName>],
    ) -> Result<Value, EvaluationStop> {
        let this = function.this.clone();
        match &function.code {
            FunctionCode::Lambda(lambda) => {
                if lambda.parameters.len() != arguments.len() {
                    return self.reject("a lambda expression gets another number of arguments");
                }
                self.java.argument_types = None;
                let from =
                    self.activate(function.class, this, "a lambda expression", function.line)?;
                if let Some(activation) = self.java.activations.last_mut() {
                    activation.locals.clone_from(&function.locals);
                    activation.lambda = Some(Arc::clone(lambda));
                }
                let result = self.run_lambda(lambda, arguments, types);
                self.leave(from, &result);
                result
            }
            FunctionCode::Reference(reference, receiver) => {
                let name = reference.name.as_deref().unwrap_or("new");
                let from = self.activate(function.class, this, name, function.line)?;
                if let Some(activation) = self.java.activations.last_mut() {
                    activation.locals.clone_from(&function.locals);
                }
                let result = self.run_reference(reference, receiver.as_ref(), arguments, types);
                self.leave(from, &result);
                result
            }
            FunctionCode::Combined(combined) => self.run_combined(combined, arguments),
        }
    }

    fn run_lambda(
        &mut self,
        lambda: &Lambda,
        arguments: &[Value],
        types: &[Option<TypeName>],
    ) -> Result<Value, EvaluationStop> {
        for (place, (parameter, value)) in lambda.parameters.iter().zip(arguments).enumerate() {
            let type_name = match parameter.type_name.name.as_str() {
                "var" => types.get(place).cloned().flatten(),
                _ => Some(parameter.type_name.clone()),
            };
            let value = match &type_name {
                Some(type_name) => self.for_variable(value.clone(), type_name)?,
                None => value.clone(),
            };
            self.java.declare(&parameter.name, type_name.as_ref(), value);
        }
        match self.block(&lambda.body)? {
            crate::flow::Flow::Return(value) => Ok(value),
            _ => Ok(Value::Null),
        }
    }

    fn run_reference(
        &mut self,
        reference: &Reference,
        receiver: Option<&Value>,
        arguments: &[Value],
        types: &[Option<TypeName>],
    ) -> Result<Value, EvaluationStop> {
        let Some(name) = &reference.name else {
            let ReferenceTarget::Type(type_name) = &reference.target else {
                return self.reject("a constructor of no class");
            };
            self.set_argument_types(simple(&type_name.name), arguments, types);
            return self.new_by_reference(type_name, arguments);
        };
        if let Some(receiver) = receiver {
            let name = method_of_list(receiver, name, types);
            self.set_argument_types(name, arguments, types);
            return self.call_on(receiver, name, arguments);
        }
        let class = match &reference.target {
            ReferenceTarget::Type(type_name) if type_name.dimensions > 0 => Value::Null,
            ReferenceTarget::Type(type_name) => match self.class_named(&type_name.name) {
                Some(id) => Value::Class(id),
                None => Value::ForeignClass(Rc::from(simple(&type_name.name))),
            },
            ReferenceTarget::Expression(expression) => self.evaluated(expression)?,
        };
        let statics = match &class {
            Value::Class(id) => self.has_static(*id, name, arguments),
            Value::ForeignClass(class) => {
                let class = Rc::clone(class);
                self.set_argument_types(name, arguments, types);
                if let Some(value) = self.library_static(&class, name, arguments)? {
                    return Ok(value);
                }
                !arguments.first().is_some_and(|first| may_be_of(first, &class))
            }
            _ => false,
        };
        if statics {
            self.set_argument_types(name, arguments, types);
            return self.call_on(&class, name, arguments);
        }
        let Some((first, others)) = arguments.split_first() else {
            return self.reject(format!("the method reference `{name}` gets no object"));
        };
        let types = types.get(1..).unwrap_or_default();
        let name = method_of_list(first, name, types);
        self.set_argument_types(name, others, types);
        self.call_on(first, name, others)
    }

    /// Returns true if a class has a static method of this name that accepts these arguments.
    fn has_static(&self, id: ClassId, name: &str, arguments: &[Value]) -> bool {
        let methods = self.java.classes.methods(id, name).into_iter();
        let mut statics = methods.filter(|(_, method)| method.is_static);
        let is_of_enum = self.java.classes.known(id).class.kind == ClassKind::Enum
            && matches!(name, "valueOf" | "values");
        is_of_enum || statics.any(|(owner, method)| self.fit(owner, &method, arguments).is_some())
    }

    fn new_by_reference(
        &mut self,
        type_name: &TypeName,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        if type_name.dimensions > 0 {
            return self.new_array(type_name, arguments);
        }
        match self.class_named(&type_name.name) {
            Some(class) => {
                let captured = self.captured(class, false);
                self.construct(class, arguments, captured)
            }
            None => self.new_of_library(simple(&type_name.name), arguments),
        }
    }

    /// Sets the argument types if the method is overloaded.
    fn set_argument_types(&mut self, name: &str, arguments: &[Value], types: &[Option<TypeName>]) {
        let is_overloaded = self.java.classes.is_overloaded(name);
        self.java.argument_types = is_overloaded.then(|| {
            let mut types = types.to_vec();
            types.resize(arguments.len(), None);
            (name.to_owned(), types)
        });
    }
}

/// Returns the composition depth of a value's function.
fn depth(value: &Value) -> usize {
    match value {
        Value::Function(function) => function.depth,
        Value::Object(object) => object.function.as_ref().map_or(0, |function| function.depth),
        _ => 0,
    }
}

/// Selects the `remove` of a list: it takes an index only through an interface with a primitive
/// parameter; type variables are objects.
fn method_of_list<'n>(receiver: &Value, name: &'n str, types: &[Option<TypeName>]) -> &'n str {
    let is_index =
        types.first().is_some_and(|type_name| type_name.as_ref().is_some_and(is_primitive));
    match (receiver, name) {
        (Value::List(_), "remove") if !types.is_empty() && !is_index => REMOVE_ELEMENT,
        _ => name,
    }
}

/// Returns true for `System.out` and `System.err`, which the evaluator represents as classes.
fn is_print_stream(expression: &Expression) -> bool {
    match &expression.kind {
        ExpressionKind::Field { name, .. } => matches!(name.as_str(), "out" | "err"),
        _ => false,
    }
}

/// Returns false if a value is certainly not of a Java library class.
fn may_be_of(value: &Value, class: &str) -> bool {
    match class_of_value(value) {
        Some(value_class) => {
            value_class == class || !matches!(class, "Math" | "Arrays" | "Collections")
        }
        None => true,
    }
}
