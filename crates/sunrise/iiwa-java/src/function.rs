//! Lambda expressions and method references as values.

use std::{cell::RefCell, collections::BTreeSet, sync::Arc};

use crate::{
    syntax::{Lambda, Reference},
    value::{Combined, Function, FunctionCode, Value},
};

/// Code of a function, for the effect search.
#[derive(Clone, Debug)]
pub(crate) enum FunctionSyntax {
    Lambda(Arc<Lambda>),
    Reference(Arc<Reference>),
}

/// Function that has been evaluated.
#[derive(Debug)]
pub(crate) struct KnownFunction {
    pub(crate) syntax: FunctionSyntax,
    /// Names of the abstract methods that the function implements; empty while its interface is
    /// unknown.
    pub(crate) methods: RefCell<BTreeSet<String>>,
}

impl FunctionSyntax {
    /// Returns the memory address.
    pub(crate) fn address(&self) -> usize {
        match self {
            Self::Lambda(lambda) => Arc::as_ptr(lambda).cast::<()>() as usize,
            Self::Reference(reference) => Arc::as_ptr(reference).cast::<()>() as usize,
        }
    }
}

impl Function {
    pub(crate) fn kind(&self) -> &'static str {
        match self.code {
            FunctionCode::Lambda(..) => "a lambda expression",
            FunctionCode::Reference(..) => "a method reference",
            FunctionCode::Combined(_) => "a function of Java's library",
        }
    }

    /// Returns true if two functions come from the same place in a source: a JVM may represent them
    /// by one object.
    pub(crate) fn may_be_same(&self, other: &Self) -> bool {
        match (&self.code, &other.code) {
            (FunctionCode::Lambda(a), FunctionCode::Lambda(b)) => Arc::ptr_eq(a, b),
            (FunctionCode::Reference(a, _), FunctionCode::Reference(b, _)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }

    /// Returns the syntax of a lambda expression or a method reference; `None` for a library
    /// function.
    pub(crate) fn syntax(&self) -> Option<FunctionSyntax> {
        match &self.code {
            FunctionCode::Lambda(lambda) => Some(FunctionSyntax::Lambda(Arc::clone(lambda))),
            FunctionCode::Reference(reference, _) => {
                Some(FunctionSyntax::Reference(Arc::clone(reference)))
            }
            FunctionCode::Combined(_) => None,
        }
    }
}

impl Combined {
    /// Returns the functions that this function is composed of.
    pub(crate) fn parts(&self) -> Vec<&Value> {
        match self {
            Self::Identity | Self::ByEntry { .. } => Vec::new(),
            Self::Not { predicate: function, .. } | Self::Reversed(function) => vec![function],
            Self::ByKey { key, order, .. } => std::iter::once(key).chain(order).collect(),
            Self::Chain { first, second, .. }
            | Self::Both { first, second, .. }
            | Self::And { first, second, .. }
            | Self::Or { first, second, .. }
            | Self::Then(first, second) => vec![first, second],
        }
    }
}
