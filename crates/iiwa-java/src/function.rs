//! Lambda expressions and method references as values.

use std::{
    cell::{OnceCell, RefCell},
    collections::BTreeSet,
    rc::Rc,
    sync::Arc,
};

use crate::{
    class_id::ClassId,
    java_state::Local,
    syntax::{Lambda, Reference, TypeName},
    value::{Object, Value},
};

/// An object of a functional interface, of which only the abstract method is given.
#[derive(Debug)]
pub struct Function {
    /// The class in which it is written.
    pub(crate) class: ClassId,
    /// `this` where it was evaluated.
    pub(crate) this: Option<Rc<Object>>,
    /// The local variables around it.
    pub(crate) locals: Vec<Local>,
    pub(crate) line: u32,
    pub(crate) code: Code,
    /// The levels of functions of which it is made.
    pub(crate) depth: usize,
    /// Its interface, if that is one of Java's own and known by now.
    pub(crate) interface: OnceCell<TypeName>,
}

#[derive(Debug)]
pub(crate) enum Code {
    Lambda(Arc<Lambda>),
    /// With the value before `::`, if it is a value.
    Reference(Arc<Reference>, Option<Value>),
    Combined(Combined),
}

/// Functions that methods of Java's functional interfaces make.
#[derive(Debug)]
pub(crate) enum Combined {
    /// `Function.identity()`.
    Identity,
    /// `second` gets the result of `first`, which implements this interface.
    Chain {
        first: Value,
        interface: Rc<str>,
        second: Value,
    },
    /// Both get the arguments.
    Both {
        first: Value,
        second: Value,
        interface: Rc<str>,
    },
    Not {
        of: Value,
        interface: Rc<str>,
    },
    And {
        first: Value,
        second: Value,
        interface: Rc<str>,
    },
    Or {
        first: Value,
        second: Value,
        interface: Rc<str>,
    },
    /// A comparator by keys, which `key` gives as this interface; `order` is their comparator, if it is not the natural one.
    ByKey {
        key: Value,
        interface: Rc<str>,
        order: Option<Value>,
    },
    /// A comparator by keys or values of a map's entries.
    ByEntry {
        is_key: bool,
    },
    Reversed(Value),
    /// A comparator, and one for what is equal by it.
    Then(Value, Value),
}

/// The code of a function, for the search for its effects.
#[derive(Clone, Debug)]
pub(crate) enum FunctionSyntax {
    Lambda(Arc<Lambda>),
    Reference(Arc<Reference>),
}

/// A function that has been evaluated.
#[derive(Debug)]
pub(crate) struct KnownFunction {
    pub(crate) syntax: FunctionSyntax,
    /// The names of the abstract methods that it implements; none while its interface is not known.
    pub(crate) methods: RefCell<BTreeSet<String>>,
}

impl FunctionSyntax {
    /// Its place in memory.
    pub(crate) fn address(&self) -> usize {
        match self {
            Self::Lambda(own) => Arc::as_ptr(own).cast::<()>() as usize,
            Self::Reference(own) => Arc::as_ptr(own).cast::<()>() as usize,
        }
    }
}

impl Function {
    pub(crate) fn kind(&self) -> &'static str {
        match self.code {
            Code::Lambda(..) => "a lambda expression",
            Code::Reference(..) => "a method reference",
            Code::Combined(_) => "a function of Java's library",
        }
    }

    /// True if two functions come from the same place of a source: a JVM may make one object of them.
    pub(crate) fn may_be_same(&self, other: &Self) -> bool {
        match (&self.code, &other.code) {
            (Code::Lambda(a), Code::Lambda(b)) => Arc::ptr_eq(a, b),
            (Code::Reference(a, _), Code::Reference(b, _)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }

    /// The syntax of a lambda expression or a method reference; none of a function of the library.
    pub(crate) fn syntax(&self) -> Option<FunctionSyntax> {
        match &self.code {
            Code::Lambda(lambda) => Some(FunctionSyntax::Lambda(Arc::clone(lambda))),
            Code::Reference(reference, _) => Some(FunctionSyntax::Reference(Arc::clone(reference))),
            Code::Combined(_) => None,
        }
    }
}

impl Combined {
    /// The functions of which it is made.
    pub(crate) fn parts(&self) -> Vec<&Value> {
        match self {
            Self::Identity | Self::ByEntry { .. } => Vec::new(),
            Self::Not { of, .. } | Self::Reversed(of) => vec![of],
            Self::ByKey { key, order, .. } => std::iter::once(key).chain(order).collect(),
            Self::Chain { first, second, .. }
            | Self::Both { first, second, .. }
            | Self::And { first, second, .. }
            | Self::Or { first, second, .. }
            | Self::Then(first, second) => vec![first, second],
        }
    }
}
