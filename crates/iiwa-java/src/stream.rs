//! Streams, collectors and optional values of Java's library.

use std::{cell::Cell, rc::Rc};

use crate::{type_names::plain, value::Value};

/// A stream of `java.util.stream`.
#[derive(Debug)]
pub struct Stream {
    pub(crate) kind: StreamKind,
    /// The collection or array, which is read by the terminal operation.
    pub(crate) source: Value,
    pub(crate) stages: Vec<Stage>,
    /// True once another operation has taken its elements.
    pub(crate) is_used: Cell<bool>,
}

/// The type of a stream's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StreamKind {
    Object,
    Int,
    Long,
    Double,
}

/// An intermediate operation. Functions have the names of their interfaces.
#[derive(Clone, Debug)]
pub(crate) enum Stage {
    Map(Value, Rc<str>),
    Filter(Value, Rc<str>),
    Peek(Value, Rc<str>),
    /// Elements as those of another type.
    Convert(StreamKind),
    Limit(usize),
    Skip(usize),
    Sorted(Option<Value>),
    Distinct,
}

/// A collector of `Collectors`.
#[derive(Debug)]
pub enum Collector {
    /// `toList()`.
    List,
    /// `toSet()`.
    Set,
    /// `joining(between, before, behind)`.
    Joining([Rc<str>; 3]),
    /// `counting()`.
    Counting,
    /// `toMap(key, value)`.
    Map(Value, Value),
    /// `groupingBy(key)`.
    Grouping(Value),
}

impl StreamKind {
    /// The beginning of the names of its functional interfaces.
    pub(crate) fn prefix(self) -> &'static str {
        match self {
            Self::Object => "",
            Self::Int => "Int",
            Self::Long => "Long",
            Self::Double => "Double",
        }
    }

    /// The type of elements in arrays.
    pub(crate) fn element(self) -> &'static str {
        match self {
            Self::Object => "Object",
            Self::Int => "int",
            Self::Long => "long",
            Self::Double => "double",
        }
    }

    pub(crate) fn converted(self, value: Value) -> Value {
        value.converted_to(&plain(self.element()))
    }

    /// The kind of the stream of an array of this type.
    pub(crate) fn of_element(element: &str) -> Option<Self> {
        [Self::Int, Self::Long, Self::Double].into_iter().find(|own| own.element() == element)
    }
}

impl Stage {
    /// The function that the stage runs.
    pub(crate) fn function(&self) -> Option<&Value> {
        match self {
            Self::Map(of, _) | Self::Filter(of, _) | Self::Peek(of, _) => Some(of),
            Self::Sorted(of) => of.as_ref(),
            _ => None,
        }
    }

    /// True if as many elements come out as go in.
    pub(crate) fn keeps_count(&self) -> bool {
        matches!(self, Self::Map(..) | Self::Peek(..) | Self::Convert(_) | Self::Sorted(_))
    }
}
