//! Kinds and stages of streams.

use crate::{
    type_names::plain,
    value::{StreamKind, StreamStage, Value},
};

impl StreamKind {
    /// Returns the name prefix of the functional interfaces.
    pub(crate) fn prefix(self) -> &'static str {
        match self {
            Self::Object => "",
            Self::Int => "Int",
            Self::Long => "Long",
            Self::Double => "Double",
        }
    }

    /// Returns the element type in arrays.
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

    /// Returns the stream kind of an array with this element type.
    pub(crate) fn of_element(element: &str) -> Option<Self> {
        [Self::Int, Self::Long, Self::Double].into_iter().find(|kind| kind.element() == element)
    }
}

impl StreamStage {
    /// Returns the function that the stage runs.
    pub(crate) fn function(&self) -> Option<&Value> {
        match self {
            Self::Map(source, _) | Self::Filter(source, _) | Self::Peek(source, _) => Some(source),
            Self::Sorted(source) => source.as_ref(),
            _ => None,
        }
    }

    /// Returns true if the stage keeps the number of elements.
    pub(crate) fn keeps_count(&self) -> bool {
        matches!(self, Self::Map(..) | Self::Peek(..) | Self::Convert(_) | Self::Sorted(_))
    }
}
