//! How a part of a machine is.

use std::borrow::Cow;

use serde::Serialize;

/// How a part of a machine is, as `diagnostic_msgs/msg/DiagnosticStatus` has it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnostic<'a> {
    /// Whether all is well.
    pub level: DiagnosticLevel,
    /// Which part, as `drive`.
    pub name: Cow<'a, str>,
    /// How it is, in words.
    pub message: Cow<'a, str>,
    /// The machine.
    pub hardware_id: Cow<'a, str>,
    /// Keys and values.
    pub values: Vec<(Cow<'a, str>, Cow<'a, str>)>,
}

/// How well a part of a machine is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiagnosticLevel {
    /// All is well.
    Ok,
    /// Something is about to be wrong.
    Warning,
    /// It does not work.
    Error,
    /// It is not known: nothing comes from it.
    Stale,
}

impl Serialize for DiagnosticLevel {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u8(*self as u8)
    }
}
