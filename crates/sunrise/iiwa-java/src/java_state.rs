//! What the evaluator holds of Java: classes, static fields, and the methods that are being run.

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
    syntax::{Lambda, TypeName, TypeParameter},
    value::{Local, Object, Value},
};

/// Statements that an application may take.
pub(crate) const MAX_STEPS: u32 = 100_000;
/// Methods that may call each other.
pub(crate) const MAX_DEPTH: usize = 100;

/// Statements and expressions within each other, those of all methods that are being run.
pub(crate) const MAX_NESTING: usize = 5_000;

pub(crate) struct JavaState {
    pub(crate) classes: Classes,
    pub(crate) statics: HashMap<(ClassId, String), Value>,
    /// Those whose static fields have their first values.
    pub(crate) initialized: HashSet<ClassId>,
    /// The constants of enums in order.
    pub(crate) constants: HashMap<ClassId, Vec<Value>>,
    /// The methods that are being run, the outermost first.
    pub(crate) activations: Vec<Activation>,
    pub(crate) steps: u32,
    pub(crate) nesting: usize,
    /// What methods of a name do, as far as it was asked.
    pub(crate) effects: HashMap<String, Effects>,
    /// Lambda expressions and method references that have been evaluated, by where they are in memory.
    pub(crate) functions: HashMap<usize, KnownFunction>,
    /// All objects, for what is not known of them any longer.
    pub(crate) objects: Vec<Weak<Object>>,
    /// Assignments that changed something which outlives a turn of the innermost loop.
    pub(crate) changes: u64,
    /// The name of the method that is called, and the types of its arguments, while it is searched for.
    pub(crate) argument_types: Option<(String, Vec<Option<TypeName>>)>,
    /// The objects of string literals: equal ones are the same object.
    pub(crate) literals: HashMap<String, Rc<str>>,
}

/// A method that is being run.
pub(crate) struct Activation {
    /// The class in which it stands.
    pub(crate) class: ClassId,
    pub(crate) this: Option<Rc<Object>>,
    pub(crate) locals: Vec<Local>,
    /// Its name.
    pub(crate) method: String,
    /// How many locals there are outside of the innermost loop.
    pub(crate) outside_loop: usize,
    /// The lambda expression, if it is one.
    pub(crate) lambda: Option<Arc<Lambda>>,
    /// The type variables that the method declares.
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

    /// The method that is being run.
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
