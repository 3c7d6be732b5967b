//! Values of the host.

use std::{any::Any, fmt::Debug, rc::Rc};

use crate::unknown::Unknown;

/// Object of a class that only the host of an evaluation knows. Copies refer to the same object, as
/// in Java.
pub trait HostValue: Any + Debug {
    /// Returns true if both values are the same object.
    fn is_same(&self, other: &dyn HostValue) -> bool;

    /// Returns a description with an article for messages, such as "a frame".
    fn kind(&self) -> &str;

    /// Returns the simple name of the Java class.
    fn class(&self) -> &str;

    /// Returns true if its methods change the object.
    fn is_mutable(&self) -> bool;

    /// Marks the contents that its methods may have changed as unknown.
    fn forget(&self, unknown: &Rc<Unknown>);

    /// Returns true if code with this object can act: a method without source might do so.
    fn can_act(&self) -> bool;
}
