//! Numbers of a column.

/// Type of stored values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Physical {
    Int32,
    Int64,
    Float,
    Double,
    /// Bytes of this length, from 1 to 16.
    Fixed(usize),
}

/// Meaning of stored values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    /// Signed integer or floating-point number.
    Number,
    Unsigned,
    /// Floating-point number of 16 bits.
    Half,
    /// Integer times 10 to the power of `-scale`.
    Decimal {
        scale: i32,
    },
    /// Time since any origin.
    Timestamp {
        per_s: f64,
    },
}

/// Type of the numbers of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NumberType {
    pub(super) physical: Physical,
    pub(super) meaning: Meaning,
}

/// Stored number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum StoredNumber {
    Integer(i128),
    Float(f64),
}

impl Physical {
    /// Length of a value, in bytes.
    pub(super) fn length(self) -> usize {
        match self {
            Self::Int32 | Self::Float => 4,
            Self::Int64 | Self::Double => 8,
            Self::Fixed(length) => length,
        }
    }
}

impl NumberType {
    /// Reads a value of its length: integers and floats are little-endian, decimals big-endian.
    pub(super) fn number(self, bytes: &[u8]) -> Option<StoredNumber> {
        Some(match self.physical {
            Physical::Int32 => {
                let value = i32::from_le_bytes(bytes.try_into().ok()?);
                self.integer(value.into())
            }
            Physical::Int64 => self.integer(i64::from_le_bytes(bytes.try_into().ok()?)),
            Physical::Float => {
                StoredNumber::Float(f32::from_le_bytes(bytes.try_into().ok()?).into())
            }
            Physical::Double => StoredNumber::Float(f64::from_le_bytes(bytes.try_into().ok()?)),
            Physical::Fixed(_) if self.meaning == Meaning::Half => {
                StoredNumber::Float(half(u16::from_le_bytes(bytes.try_into().ok()?)))
            }
            Physical::Fixed(_) => {
                let is_negative = bytes.first()? & 0x80 != 0;
                let start = if is_negative { -1 } else { 0 };
                let value =
                    bytes.iter().fold(start, |value, byte| (value << 8) | i128::from(*byte));
                StoredNumber::Integer(value)
            }
        })
    }

    /// Interprets an integer, sign-extended from its length.
    pub(super) fn integer(self, value: i64) -> StoredNumber {
        StoredNumber::Integer(match (self.meaning, self.physical) {
            (Meaning::Unsigned, Physical::Int32) => (value & 0xffff_ffff).into(),
            (Meaning::Unsigned, _) => value.cast_unsigned().into(),
            _ => value.into(),
        })
    }

    /// Returns the value of a stored number.
    pub(super) fn value(self, stored: StoredNumber) -> f64 {
        match (stored, self.meaning) {
            (StoredNumber::Float(value), _) => value,
            (StoredNumber::Integer(value), Meaning::Decimal { scale }) if scale >= 0 => {
                value as f64 / 10_f64.powi(scale)
            }
            (StoredNumber::Integer(value), Meaning::Decimal { scale }) => {
                value as f64 * 10_f64.powi(-scale)
            }
            (StoredNumber::Integer(value), _) => value as f64,
        }
    }
}

/// Returns the value of a floating-point number of 16 bits (IEEE 754 binary16).
fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let fraction = f64::from(bits & 0x3ff);
    let size = match (bits >> 10) & 0x1f {
        0 => fraction * 2_f64.powi(-24),
        0x1f if fraction == 0.0 => f64::INFINITY,
        0x1f => f64::NAN,
        exponent => (1024.0 + fraction) * 2_f64.powi(i32::from(exponent) - 25),
    };
    sign * size
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_have_their_values() {
        for (bits, value) in [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x0001, 2_f64.powi(-24)),
            (0x0400, 2_f64.powi(-14)),
            (0x3555, 0.333_251_953_125),
            (0x0000, 0.0),
            (0xfc00, f64::NEG_INFINITY),
        ] {
            assert_eq!(half(bits), value, "{bits:x}");
        }
        assert!(half(0x7e00).is_nan());
    }

    #[test]
    fn decimals_are_big_endian() {
        let decimal = |length, scale| NumberType {
            physical: Physical::Fixed(length),
            meaning: Meaning::Decimal { scale },
        };
        let value = |kind: NumberType, bytes: &[u8]| kind.number(bytes).map(|it| kind.value(it));
        assert_eq!(value(decimal(2, 2), &[0x01, 0x45]), Some(3.25));
        assert_eq!(value(decimal(2, 2), &[0xfe, 0xbb]), Some(-3.25));
        assert_eq!(value(decimal(16, 0), &[0xff; 16]), Some(-1.0));
        assert_eq!(value(decimal(1, -2), &[3]), Some(300.0));
        assert_eq!(value(decimal(2, 2), &[]), None);
    }
}
