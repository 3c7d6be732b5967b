//! Java state of the evaluator: classes, static fields, and running methods.

use std::{
    collections::{HashMap, HashSet},
    rc::{Rc, Weak},
    sync::Arc,
};

use crate::{
    class_id::ClassId,
    classes::Classes,
    effects::Effects,
    function::KnownFunction,
    place::SourceLine,
    syntax::{Lambda, TypeName, TypeParameter},
    value::{JavaObject, Local, Value},
};

/// Maximum number of statements of an application.
pub(crate) const MAX_STEPS: u32 = 100_000;
/// Maximum depth of method calls.
pub(crate) const MAX_DEPTH: usize = 100;

/// Maximum nesting depth of statements and expressions, over all running methods.
pub(crate) const MAX_NESTING: usize = 5_000;

pub(crate) struct JavaState {
    pub(crate) classes: Classes,
    pub(crate) statics: HashMap<(ClassId, String), Value>,
    /// Classes whose static fields are initialised.
    pub(crate) initialized: HashSet<ClassId>,
    /// Enum constants in order.
    pub(crate) constants: HashMap<ClassId, Vec<Value>>,
    /// Running methods, the outermost first.
    pub(crate) activations: Vec<Activation>,
    pub(crate) steps: u32,
    pub(crate) nesting: usize,
    /// Known effects of methods, by name.
    pub(crate) effects: HashMap<String, Effects>,
    /// Evaluated lambda expressions and method references, by memory address.
    pub(crate) functions: HashMap<usize, KnownFunction>,
    /// All objects, to mark their contents as unknown.
    pub(crate) objects: Vec<Weak<JavaObject>>,
    /// Number of assignments that changed state which outlives an iteration of the innermost loop.
    pub(crate) changes: u64,
    /// Name and argument types of a call while its method is being resolved.
    pub(crate) argument_types: Option<(String, Vec<Option<TypeName>>)>,
    /// Objects of string literals: equal literals are the same object.
    pub(crate) literals: HashMap<String, Rc<str>>,
}

/// Running method.
pub(crate) struct Activation {
    /// Class that contains the code.
    pub(crate) class: ClassId,
    /// Place of the call.
    pub(crate) from: SourceLine,
    pub(crate) this: Option<Rc<JavaObject>>,
    pub(crate) locals: Vec<Local>,
    /// Name of the method.
    pub(crate) method: String,
    /// Number of locals outside of the innermost loop.
    pub(crate) outside_loop: usize,
    /// Lambda expression, if the activation is one.
    pub(crate) lambda: Option<Arc<Lambda>>,
    /// Type variables that the method declares.
    pub(crate) type_parameters: Vec<TypeParameter>,
}

impl JavaState {
    pub(crate) fn new(classes: Classes) -> Self {
        Self {
            classes,
            statics: HashMap::new(),
            initialized: HashSet::new(),
            constants: HashMap::new(),
            activations: Vec::new(),
            steps: 0,
            nesting: 0,
            effects: HashMap::new(),
            functions: HashMap::new(),
            objects: Vec::new(),
            changes: 0,
            argument_types: None,
            literals: HashMap::new(),
        }
    }

    /// Returns the running method.
    pub(crate) fn activation(&self) -> Option<&Activation> {
        self.activations.last()
    }

    pub(crate) fn locals_mut(&mut self) -> Option<&mut Vec<Local>> {
        self.activations.last_mut().map(|activation| &mut activation.locals)
    }

    /// Adds a local variable.
    pub(crate) fn declare(&mut self, name: &str, type_name: Option<&TypeName>, value: Value) {
        if let Some(locals) = self.locals_mut() {
            let value = type_name.map_or(value.clone(), |wanted| value.converted_to(wanted));
            locals.push(Local {
                name: name.to_owned(),
                type_name: type_name.cloned(),
                value,
                is_assigned: true,
            });
        }
    }
}
