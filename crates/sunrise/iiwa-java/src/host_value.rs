//! Values that are not Java's.

use std::{any::Any, fmt::Debug, rc::Rc};

use crate::unknown::Unknown;

/// An object of a class that only the host of an evaluation knows. Copies are the same object, as in Java.
pub trait HostValue: Any + Debug {
    /// Whether it is the same object.
    fn is_same(&self, other: &dyn HostValue) -> bool;

    /// What it is, with its article, for messages: "a frame".
    fn kind(&self) -> &str;

    /// Its class in Java, by its simple name.
    fn class(&self) -> &str;

    /// Whether its methods change it.
    fn is_mutable(&self) -> bool;

    /// Makes unknown what its methods may have changed.
    fn forget(&self, unknown: &Rc<Unknown>);

    /// Whether code that has it can act: a method that is not looked into might.
    fn can_act(&self) -> bool;
}
