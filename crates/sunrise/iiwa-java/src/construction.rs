//! Object construction: constructors, field initialisers, injection.

use std::{cell::RefCell, collections::HashMap, rc::Rc, sync::Arc};

use crate::{
    class_id::ClassId,
    classes::simple,
    java_state::MAX_STEPS,
    machine::Machine,
    overloads::Choice,
    place::SourceLine,
    stop::EvaluationStop,
    syntax::{
        Annotation, Class, ClassKind, Expression, ExpressionKind, Field, Member, Method,
        StatementKind, TypeName,
    },
    value::{JavaObject, Value},
    variables::fields,
};

impl Machine {
    /// Evaluates `new Name(...)`.
    pub(crate) fn new_object(
        &mut self,
        expression: &Expression,
        type_name: &TypeName,
        arguments: &[Expression],
        body: Option<&Arc<Class>>,
    ) -> Result<Value, EvaluationStop> {
        let types = self.types_of_arguments(simple(&type_name.name), arguments);
        let arguments = self.evaluated_all(arguments)?;
        self.place.line = expression.line;
        for value in &arguments {
            self.refresh(value);
        }
        self.java.argument_types = types;
        let Some(within) = self.java.activation().map(|activation| activation.class) else {
            return self.reject("an object is made outside of a class");
        };
        let class = match body {
            Some(body) => Some(self.class_in_method(body, within)),
            None => self.class_named(&type_name.name),
        };
        let Some(class) = class else {
            return self.new_of_library(simple(&type_name.name), &arguments);
        };
        let captured = self.captured(class, body.is_some());
        self.construct(class, &arguments, captured)
    }

    /// Resolves a class name at the current place: a class declared in this method, or another
    /// project class.
    pub(crate) fn class_named(&self, name: &str) -> Option<ClassId> {
        let within = self.java.activation()?.class;
        self.variable_class(name).or_else(|| self.java.classes.find(name, within))
    }

    /// Evaluates `new Class(arguments)` for a class outside the project.
    pub(crate) fn new_of_library(
        &mut self,
        class: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        if let Some(value) = self.foreign_new(class, arguments)? {
            return Ok(value);
        }
        self.may_act_with(class, arguments);
        let result = self.unknown(format!("a `{class}`, of a library without source"));
        let functions = arguments.iter().filter(|argument| argument.function().is_some());
        let functions: Vec<_> = functions.cloned().collect();
        self.after_unmodelled(None, class, &functions, &result)?;
        Ok(result)
    }

    /// Returns a class that is declared in this method.
    fn variable_class(&self, name: &str) -> Option<ClassId> {
        let locals = &self.java.activation()?.locals;
        let local = locals.iter().rev().find(|local| local.name == name)?;
        match &local.value {
            Value::Class(id) => Some(*id),
            _ => None,
        }
    }

    /// Returns a local or anonymous class in a method of another class.
    pub(crate) fn class_in_method(&mut self, class: &Arc<Class>, outer: ClassId) -> ClassId {
        let before = self.java.classes.ids().count();
        let id = self.java.classes.in_method(class, outer);
        if self.java.classes.ids().count() != before {
            // The new class may add effects to calls that were analysed before.
            self.java.effects.clear();
        }
        id
    }

    /// Returns the local variables that a local class captures.
    pub(crate) fn captured(&self, class: ClassId, is_anonymous: bool) -> HashMap<String, Value> {
        let Some(activation) = self.java.activation() else { return HashMap::new() };
        let is_local =
            is_anonymous || self.java.classes.known(class).outer == Some(activation.class);
        let mut seen = HashMap::new();
        if is_local {
            if let Some(this) = &activation.this {
                seen.extend(this.captured.clone());
            }
            let locals = activation.locals.iter();
            seen.extend(locals.map(|local| (local.name.clone(), local.value.clone())));
        }
        seen
    }

    /// Constructs an object of a project class.
    pub(crate) fn construct(
        &mut self,
        class: ClassId,
        arguments: &[Value],
        captured: HashMap<String, Value>,
    ) -> Result<Value, EvaluationStop> {
        if let Some(again) = self.java.classes.cycle(class) {
            let [class_name, again] =
                [class, again].map(|id| self.java.classes.known(id).class.name.clone());
            return self
                .reject(format!("the class {class_name} inherits from itself, by way of {again}"));
        }
        let declaration = Arc::clone(&self.java.classes.known(class).class);
        if declaration.is_abstract || declaration.kind == ClassKind::Interface {
            return self
                .reject(format!("{} is abstract: no object of it can be made", declaration.name));
        }
        self.initialize(class)?;
        let object = self.bare(class, captured, None);
        self.constructed(&object, class, arguments)?;
        Ok(Value::Object(object))
    }

    /// Creates an object without running its constructors.
    fn bare(
        &mut self,
        class: ClassId,
        captured: HashMap<String, Value>,
        constant: Option<(Rc<str>, i32)>,
    ) -> Rc<JavaObject> {
        let this = self.java.activation().and_then(|activation| activation.this.clone());
        // The enclosing object is an instance of the enclosing class or of its subclass.
        let outer = self.java.classes.known(class).outer.and_then(|outer| {
            let mut around = this;
            while let Some(object) = around {
                if self.java.classes.is_a(object.class, outer) {
                    return Some(Value::Object(object));
                }
                around = match &object.outer {
                    Some(Value::Object(outer)) => Some(Rc::clone(outer)),
                    _ => None,
                };
            }
            None
        });
        let object = Rc::new(JavaObject {
            class,
            fields: RefCell::default(),
            outer,
            captured,
            constant,
            inherited: RefCell::default(),
            message: RefCell::default(),
            function: None,
        });
        self.java.objects.push(Rc::downgrade(&object));
        object
    }

    /// Runs the constructor of a class on an object, after those of its superclasses.
    fn constructed(
        &mut self,
        object: &Rc<JavaObject>,
        class: ClassId,
        arguments: &[Value],
    ) -> Result<(), EvaluationStop> {
        let declaration = Arc::clone(&self.java.classes.known(class).class);
        let constructors = &declaration.constructors;
        let all = constructors.iter().map(|constructor| (class, Arc::clone(constructor))).collect();
        let Some(choice) = self.chosen(all, &declaration.name, arguments) else {
            if constructors.is_empty() {
                // An anonymous class passes its arguments to the superclass.
                self.constructed_above(object, class, arguments)?;
                return self.first_values(object, class);
            }
            return self.reject(format!(
                "{} has no constructor for these {} arguments",
                declaration.name,
                arguments.len()
            ));
        };
        let constructor = match choice {
            Choice::Method(_, constructor) => constructor,
            Choice::Undecided(unknown, _) => {
                let name = &declaration.name;
                return self.reject_unknown(
                    &format!("which of the constructors of {name} is called"),
                    &unknown,
                );
            }
        };
        let from = self.enter(class, Some(Rc::clone(object)), &constructor, arguments)?;
        let result = self.in_constructor(object, class, &constructor);
        self.leave(from, &result);
        result
    }

    fn in_constructor(
        &mut self,
        object: &Rc<JavaObject>,
        class: ClassId,
        constructor: &Method,
    ) -> Result<(), EvaluationStop> {
        let body = constructor.body.as_deref().unwrap_or_default();
        let first = body.first().and_then(|statement| match &statement.kind {
            StatementKind::Expression(call) => match &call.kind {
                ExpressionKind::ThisCall(arguments) => Some((true, arguments, call.line)),
                ExpressionKind::SuperCall(arguments) => Some((false, arguments, call.line)),
                _ => None,
            },
            _ => None,
        });
        let rest = if let Some((is_own, arguments, line)) = first {
            self.place.line = line;
            let above = self.java.classes.parent(class).filter(|_| !is_own).unwrap_or(class);
            let name = self.java.classes.known(above).class.name.clone();
            let types = self.types_of_arguments(&name, arguments);
            let arguments = self.evaluated_all(arguments)?;
            self.java.argument_types = types;
            if is_own {
                self.constructed(object, class, &arguments)?;
            } else {
                self.constructed_above(object, class, &arguments)?;
                self.first_values(object, class)?;
            }
            body.get(1..).unwrap_or_default()
        } else {
            self.constructed_above(object, class, &[])?;
            self.first_values(object, class)?;
            body
        };
        self.block(rest).map(|_| ())
    }

    fn constructed_above(
        &mut self,
        object: &Rc<JavaObject>,
        class: ClassId,
        arguments: &[Value],
    ) -> Result<(), EvaluationStop> {
        if let Some(parent) = self.java.classes.parent(class) {
            if self.java.classes.known(parent).class.kind == ClassKind::Interface {
                return Ok(());
            }
            self.initialize(parent)?;
            return self.constructed(object, parent, arguments);
        }
        let Some(base) = self.java.classes.foreign_parent(class).map(str::to_owned) else {
            return Ok(());
        };
        if base.ends_with("Exception") || base.ends_with("Error") {
            let message = match arguments.first() {
                None => Value::Null,
                Some(message @ (Value::Text(_) | Value::Null | Value::Unknown(_))) => {
                    message.clone()
                }
                Some(_) => self.unknown("the message of an exception of another one"),
            };
            *object.message.borrow_mut() = Some(message);
            return Ok(());
        }
        Rc::clone(&self.host).constructed(self, object, &base, arguments)
    }

    /// Initialises the instance fields of a class, in order.
    fn first_values(
        &mut self,
        object: &Rc<JavaObject>,
        class: ClassId,
    ) -> Result<(), EvaluationStop> {
        let declaration = Arc::clone(&self.java.classes.known(class).class);
        let own_fields = fields(&declaration.members).filter(|field| !field.is_static);
        for field in own_fields {
            let default = Value::default_of(&field.type_name);
            object.fields.borrow_mut().insert((class, field.name.clone()), default);
        }
        let from = self.activate(class, Some(Rc::clone(object)), "", declaration.line)?;
        let result = declaration.members.iter().try_for_each(|member| match member {
            Member::Field(field) if !field.is_static => self.first_value(object, class, field),
            Member::Initializer { is_static: false, body } => self.block(body).map(|_| ()),
            _ => Ok(()),
        });
        self.leave(from, &result);
        result
    }

    fn first_value(
        &mut self,
        object: &Rc<JavaObject>,
        class: ClassId,
        field: &Field,
    ) -> Result<(), EvaluationStop> {
        self.place.line = field.line;
        let value = match &field.initial {
            Some(initial) => self.initial_value(initial, &field.type_name)?,
            None if is_injected(&field.annotations) => {
                let named = named(&field.annotations);
                self.injected(class, &field.type_name, named, &field.name)?
            }
            None => return Ok(()),
        };
        object.fields.borrow_mut().insert((class, field.name.clone()), value);
        Ok(())
    }

    /// Returns the value that the controller injects into a field or a parameter.
    fn injected(
        &mut self,
        class: ClassId,
        type_name: &TypeName,
        named: Option<&str>,
        field: &str,
    ) -> Result<Value, EvaluationStop> {
        if let Some(class) = self.java.classes.find(&type_name.name, class) {
            return self.injected_object(class);
        }
        let simple = simple(&type_name.name);
        match Rc::clone(&self.host).injected(self, simple, named, field)? {
            Some(value) => Ok(value),
            None => Ok(self.unknown(format!("a `{simple}`, of a library without source"))),
        }
    }

    /// Creates an injected object, with the constructor that is annotated for injection.
    pub(crate) fn injected_object(&mut self, class: ClassId) -> Result<Value, EvaluationStop> {
        // Classes may be injected into each other.
        self.java.steps += 100;
        if self.java.steps > MAX_STEPS {
            return self.reject("objects are injected into each other in an endless cycle");
        }
        let declaration = Arc::clone(&self.java.classes.known(class).class);
        let marked = declaration
            .constructors
            .iter()
            .find(|constructor| is_injected(&constructor.annotations));
        let constructor = marked.or(declaration.constructors.first());
        let mut arguments = Vec::new();
        for parameter in constructor.iter().flat_map(|constructor| &constructor.parameters) {
            arguments.push(self.injected(class, &parameter.type_name, None, &parameter.name)?);
        }
        self.construct(class, &arguments, HashMap::new())
    }

    /// Initialises the static fields of a class and the constants of an enum, once.
    pub(crate) fn initialize(&mut self, class: ClassId) -> Result<(), EvaluationStop> {
        if !self.java.initialized.insert(class) {
            return Ok(());
        }
        let copies = self.java.classes.copies(class).join(", ");
        if !copies.is_empty() && self.java.classes.main() != Some(class) {
            let known = self.java.classes.known(class);
            let (name, file) = (known.class.name.clone(), Rc::clone(&known.file));
            self.note(format!(
                "the class {name} is taken from {file}; there are other copies in {copies}: import \
                 from the folder of the project that is meant"
            ));
        }
        if let Some(parent) = self.java.classes.parent(class) {
            self.initialize(parent)?;
        }
        let declaration = Arc::clone(&self.java.classes.known(class).class);
        for field in fields(&declaration.members).filter(|field| field.is_static) {
            let default = Value::default_of(&field.type_name);
            self.java.statics.insert((class, field.name.clone()), default);
        }
        // A call or `new` that triggers the initialisation resolves its method afterwards, so that
        // its argument types are restored.
        let types = self.java.argument_types.take();
        let from = self.activate(class, None, "", declaration.line)?;
        let result = self.static_values(class, &declaration);
        self.leave(from, &result);
        self.java.argument_types = types;
        result
    }

    fn static_values(&mut self, class: ClassId, declaration: &Class) -> Result<(), EvaluationStop> {
        for (ordinal, constant) in (0..).zip(&declaration.constants) {
            self.place.line = constant.line;
            let arguments = self.evaluated_all(&constant.arguments)?;
            let object_class = match &constant.body {
                Some(body) => self.class_in_method(body, class),
                None => class,
            };
            let named = Some((Rc::from(constant.name.as_str()), ordinal));
            let object = self.bare(object_class, HashMap::new(), named);
            self.constructed(&object, class, &arguments)?;
            if object_class != class {
                self.first_values(&object, object_class)?;
            }
            let value = Value::Object(object);
            self.java.statics.insert((class, constant.name.clone()), value.clone());
            self.java.constants.entry(class).or_default().push(value);
        }
        for member in &declaration.members {
            match member {
                Member::Field(field) if field.is_static => {
                    self.place.line = field.line;
                    if let Some(initial) = &field.initial {
                        let value = self.initial_value(initial, &field.type_name)?;
                        self.java.statics.insert((class, field.name.clone()), value);
                    }
                }
                Member::Initializer { is_static: true, body } => {
                    self.block(body)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Creates an object of a class with injection, and runs these methods without arguments.
    ///
    /// # Errors
    ///
    /// If an exception is not caught, or if the evaluation ends before the methods do.
    pub fn run_class(&mut self, class: ClassId, methods: &[&str]) -> Result<(), EvaluationStop> {
        self.java.classes.set_main(class);
        let file = Rc::clone(&self.java.classes.known(class).file);
        let line = self.java.classes.known(class).class.line;
        self.place = SourceLine { file, line };
        let Value::Object(object) = self.injected_object(class)? else { return Ok(()) };
        for name in methods {
            if let Some((owner, method)) = self.plain_method(class, name) {
                self.run(owner, Some(Rc::clone(&object)), &method, &[])?;
            }
        }
        Ok(())
    }
}

fn is_injected(annotations: &[Annotation]) -> bool {
    annotations.iter().any(|annotation| annotation.name == "Inject")
}

/// Returns the name in `@Named("name")`.
fn named(annotations: &[Annotation]) -> Option<&str> {
    annotations.iter().find(|annotation| annotation.name == "Named")?.value.as_deref()
}
