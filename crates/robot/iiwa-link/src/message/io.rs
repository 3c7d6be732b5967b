//! Values of inputs and outputs.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, de::Visitor};

/// Value of an input or output.
///
/// ```
/// use iiwa_link::message::IoValue;
///
/// assert_eq!(serde_json::from_str::<IoValue>("7")?, IoValue::Digital(7));
/// assert_eq!(serde_json::from_str::<IoValue>("-0.5")?, IoValue::Analog(-0.5));
/// assert_eq!(serde_json::to_string(&IoValue::Boolean(true))?, "true");
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum IoValue {
    /// A boolean signal.
    Boolean(bool),
    /// An unsigned integer.
    Digital(u64),
    /// A floating-point number.
    Analog(f64),
}

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

impl<'de> Deserialize<'de> for IoValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct IoValueVisitor;
        impl Visitor<'_> for IoValueVisitor {
            type Value = IoValue;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("true, false or a number")
            }
            fn visit_bool<E>(self, value: bool) -> Result<IoValue, E> {
                Ok(IoValue::Boolean(value))
            }
            fn visit_u64<E>(self, value: u64) -> Result<IoValue, E> {
                Ok(IoValue::Digital(value))
            }
            // Negative numbers only: `serde_json` passes all other integers to `visit_u64`.
            fn visit_i64<E>(self, value: i64) -> Result<IoValue, E> {
                Ok(IoValue::Analog(value as f64))
            }
            fn visit_f64<E>(self, value: f64) -> Result<IoValue, E> {
                Ok(IoValue::Analog(value))
            }
        }
        deserializer.deserialize_any(IoValueVisitor)
    }
}

impl fmt::Display for IoValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Boolean(value) => value.fmt(f),
            Self::Digital(value) => value.fmt(f),
            // Scientific notation, which avoids hundreds of digits.
            Self::Analog(value) if value.abs() >= 1e16 || value.abs() < 1e-5 && *value != 0.0 => {
                write!(f, "{value:e}")
            }
            Self::Analog(value) => value.fmt(f),
        }
    }
}
