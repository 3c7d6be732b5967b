//! Value conversions of Java.

use crate::{syntax::TypeName, value::Value};

impl Value {
    /// Converts a value on assignment to a variable of this type.
    pub(crate) fn converted_to(self, wanted: &TypeName) -> Self {
        if wanted.dimensions > 0 {
            return self;
        }
        match wanted.name.as_str() {
            "double" | "Double" => self.number().map_or(self, Self::Double),
            #[expect(clippy::cast_possible_truncation, reason = "as Java does")]
            "float" | "Float" => self.number().map_or(self, |value| Self::Float(value as f32)),
            "long" | "Long" => self.integer().map_or(self, Self::Long),
            "int" | "Integer" | "short" | "Short" | "byte" | "Byte" => match self {
                Self::Char(code) => Self::Int(i32::from(code)),
                other => other,
            },
            "char" | "Character" => match self {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "as Java does"
                )]
                Self::Int(code) => Self::Char(code as u16),
                other => other,
            },
            _ => self,
        }
    }

    /// Converts a value by a cast.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "as Java does"
    )]
    pub(crate) fn cast_to(self, wanted: &TypeName) -> Self {
        if wanted.dimensions > 0 {
            return self;
        }
        let (Some(number), integer) = (self.number(), self.integer()) else { return self };
        // Floating-point numbers are cast by way of int or long, which saturate.
        let long = integer.unwrap_or(number as i64);
        let int = integer.map_or(number as i32, |value| value as i32);
        match wanted.name.as_str() {
            "byte" => Self::Int(i32::from(int as i8)),
            "short" => Self::Int(i32::from(int as i16)),
            "char" => Self::Char(int as u16),
            "int" => Self::Int(int),
            "long" => Self::Long(long),
            "float" => Self::Float(integer.map_or(number as f32, |value| value as f32)),
            "double" => Self::Double(number),
            _ => self.converted_to(wanted),
        }
    }

    /// Returns the default value of a field or an array element.
    pub(crate) fn default_of(wanted: &TypeName) -> Self {
        if wanted.dimensions > 0 {
            return Self::Null;
        }
        match wanted.name.as_str() {
            "boolean" => Self::Boolean(false),
            "char" => Self::Char(0),
            "byte" | "short" | "int" => Self::Int(0),
            "long" => Self::Long(0),
            "float" => Self::Float(0.0),
            "double" => Self::Double(0.0),
            _ => Self::Null,
        }
    }
}
