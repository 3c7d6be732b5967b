//! Values of inputs and outputs.

pub use iiwa_program::IoValue;
use serde::{Deserialize, Serialize};

/// An input or output with its current value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Signal {
    /// Name of the signal.
    pub name: String,
    /// Direction of the signal.
    pub direction: Direction,
    /// Current value.
    pub value: IoValue,
}

/// Direction of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// A readable signal.
    Input,
    /// A readable and writable signal.
    Output,
}

impl Direction {
    /// Returns the name in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::Output => "output",
        }
    }
}
