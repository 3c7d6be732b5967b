//! Values of inputs and outputs.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, de::Visitor};

/// Value of an input or output.
///
/// ```
/// use iiwa_program::IoValue;
///
/// assert_eq!(serde_json::from_str::<IoValue>("7")?, IoValue::Digital(7));
/// assert_eq!(serde_json::from_str::<IoValue>("-0.5")?, IoValue::Analog(-0.5));
/// assert_eq!(serde_json::to_string(&IoValue::Boolean(true))?, "true");
/// assert!(IoValue::Digital(1).is_same(IoValue::Analog(1.0)));
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

impl IoValue {
    /// Returns true if both are booleans, or both are numbers.
    #[must_use]
    pub fn is_comparable(self, other: Self) -> bool {
        matches!(self, Self::Boolean(_)) == matches!(other, Self::Boolean(_))
    }

    /// Returns true if both values are equal; a whole number equals the same number of a signal
    /// with floating-point values.
    #[must_use]
    pub fn is_same(self, other: Self) -> bool {
        #[expect(clippy::cast_precision_loss, reason = "an analog value is a float")]
        #[expect(clippy::float_cmp, reason = "a signal has the value, or has not")]
        match (self, other) {
            (Self::Digital(a), Self::Analog(b)) | (Self::Analog(b), Self::Digital(a)) => {
                a as f64 == b
            }
            (a, b) => a == b,
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
