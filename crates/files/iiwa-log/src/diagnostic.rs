//! Status of machine components.

use std::borrow::Cow;

use serde::Serialize;

/// Status of a machine component, as in `diagnostic_msgs/msg/DiagnosticStatus`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnostic<'a> {
    /// Severity.
    pub level: DiagnosticLevel,
    /// Component, for example `drive`.
    pub name: Cow<'a, str>,
    /// Status text.
    pub message: Cow<'a, str>,
    /// Identifier of the machine.
    pub hardware_id: Cow<'a, str>,
    /// Keys and values.
    pub values: Vec<(Cow<'a, str>, Cow<'a, str>)>,
}

/// Severity of a component status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiagnosticLevel {
    /// Normal operation.
    Ok,
    /// A fault is imminent.
    Warning,
    /// The component does not work.
    Error,
    /// Status unknown: no data arrives.
    Stale,
}

impl Serialize for DiagnosticLevel {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u8(*self as u8)
    }
}
