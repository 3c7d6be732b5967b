//! `Math`, and the number classes.

use std::cmp::Ordering;

use crate::{machine::Machine, stop::EvaluationStop, syntax::TypeName, value::Value};

impl Machine {
    /// Evaluates `Math.name(...)`; `None` if it is not modelled.
    pub(crate) fn math(
        &mut self,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        if name == "random" {
            return Ok(Some(self.unknown("a random number")));
        }
        if let Some(unknown) = arguments.iter().find(|value| value.unknown().is_some()) {
            return Ok(Some(unknown.clone()));
        }
        let numbers: Option<Vec<f64>> = arguments.iter().map(Value::number).collect();
        let Some(numbers) = numbers else { return Ok(None) };
        let result = match (name, numbers.as_slice()) {
            ("abs", [_]) => return self.absolute(arguments).map(Some),
            ("max" | "min", [a, b]) => {
                let is_whole = arguments.iter().all(|value| value.integer().is_some());
                let (a, b) = (*a, *b);
                let takes_first = if name == "max" { a >= b } else { a <= b };
                if is_whole {
                    let value = arguments[usize::from(!takes_first)].clone();
                    let wide = arguments.iter().any(|value| matches!(value, Value::Long(_)));
                    let wanted = if wide { "long" } else { "int" };
                    return Ok(Some(value.converted_to(&primitive(wanted))));
                }
                // Negative zero is less than positive zero.
                let (below, above) = match a.partial_cmp(&b) {
                    None => (f64::NAN, f64::NAN),
                    Some(Ordering::Less) => (a, b),
                    Some(Ordering::Equal) if a.is_sign_negative() => (a, b),
                    Some(_) => (b, a),
                };
                let value = Value::Double(if name == "max" { above } else { below });
                let is_double =
                    arguments.iter().any(|argument| matches!(argument, Value::Double(_)));
                let wanted = primitive(if is_double { "double" } else { "float" });
                return Ok(Some(value.cast_to(&wanted)));
            }
            ("round", [a]) => {
                let below = a.floor();
                let rounded = if a - below >= 0.5 { below + 1.0 } else { below };
                let is_float = matches!(arguments, [Value::Float(_)]);
                let wanted = primitive(if is_float { "int" } else { "long" });
                return Ok(Some(Value::Double(rounded).cast_to(&wanted)));
            }
            // Newer Java versions multiply by a constant instead, which may differ in the last bit.
            ("toRadians", [a]) => a / 180.0 * std::f64::consts::PI,
            ("toDegrees", [a]) => a * 180.0 / std::f64::consts::PI,
            ("sin", [a]) => a.sin(),
            ("cos", [a]) => a.cos(),
            ("tan", [a]) => a.tan(),
            ("asin", [a]) => a.asin(),
            ("acos", [a]) => a.acos(),
            ("atan", [a]) => a.atan(),
            ("atan2", [a, b]) => a.atan2(*b),
            ("sinh", [a]) => a.sinh(),
            ("cosh", [a]) => a.cosh(),
            ("tanh", [a]) => a.tanh(),
            ("sqrt", [a]) => a.sqrt(),
            ("cbrt", [a]) => a.cbrt(),
            ("pow", [a, b]) if b.is_nan() || (a.abs() == 1.0 && b.is_infinite()) => f64::NAN,
            ("pow", [a, b]) => a.powf(*b),
            ("exp", [a]) => a.exp(),
            ("log", [a]) => a.ln(),
            ("log10", [a]) => a.log10(),
            ("hypot", [a, b]) => a.hypot(*b),
            ("floor", [a]) => a.floor(),
            ("ceil", [a]) => a.ceil(),
            ("rint", [a]) => a.round_ties_even(),
            ("signum", [a]) => {
                let sign = if *a == 0.0 || a.is_nan() { *a } else { a.signum() };
                let is_float = matches!(arguments, [Value::Float(_)]);
                let wanted = primitive(if is_float { "float" } else { "double" });
                return Ok(Some(Value::Double(sign).cast_to(&wanted)));
            }
            ("floorMod" | "floorDiv", [_, _]) => {
                let (Some(a), Some(b)) = (arguments[0].integer(), arguments[1].integer()) else {
                    return Ok(None);
                };
                if b == 0 {
                    return self.throw("ArithmeticException", "/ by zero");
                }
                let modulo = a.wrapping_rem(b);
                let differs = modulo != 0 && (modulo < 0) != (b < 0);
                let value = match (name, differs) {
                    ("floorMod", true) => modulo.wrapping_add(b),
                    ("floorMod", false) => modulo,
                    (_, true) => a.wrapping_div(b) - 1,
                    (_, false) => a.wrapping_div(b),
                };
                let wide = arguments.iter().any(|value| matches!(value, Value::Long(_)));
                let wanted = if wide { "long" } else { "int" };
                return Ok(Some(Value::Long(value).cast_to(&primitive(wanted))));
            }
            _ => return Ok(None),
        };
        Ok(Some(Value::Double(result)))
    }

    fn absolute(&mut self, arguments: &[Value]) -> Result<Value, EvaluationStop> {
        Ok(match arguments {
            [Value::Int(value)] => Value::Int(value.wrapping_abs()),
            [Value::Long(value)] => Value::Long(value.wrapping_abs()),
            [Value::Float(value)] => Value::Float(value.abs()),
            [value] => Value::Double(value.number().unwrap_or_default().abs()),
            _ => return self.reject("`Math.abs` has one argument"),
        })
    }

    /// Calls a static method of a box class, such as `Integer.name(...)`; `None` if it is not
    /// modelled.
    pub(crate) fn of_box(
        &mut self,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let unboxed = match class {
            "Integer" => "int",
            "Character" => "char",
            "Long" => "long",
            "Double" => "double",
            "Float" => "float",
            "Short" => "short",
            "Byte" => "byte",
            _ => "boolean",
        };
        Ok(Some(match (name, arguments) {
            (_, [unknown @ Value::Unknown(_), ..]) => unknown.clone(),
            (
                "valueOf" | "parseInt" | "parseLong" | "parseDouble" | "parseFloat"
                | "parseBoolean" | "parseShort" | "parseByte",
                [Value::Text(text)],
            ) => return self.parsed(unboxed, text).map(Some),
            ("valueOf", [value]) => value.clone().cast_to(&primitive(unboxed)),
            ("toString", [value]) => {
                let text = self.text_of(value)?;
                text.map_or_else(Value::Unknown, Value::text)
            }
            ("compare", [Value::Char(a), Value::Char(b)]) => {
                Value::Int(i32::from(*a) - i32::from(*b))
            }
            ("compare", [Value::Boolean(a), Value::Boolean(b)]) => {
                Value::Int(i32::from(*a) - i32::from(*b))
            }
            ("compare", [a, b]) => {
                let (Some(a), Some(b)) = (a.number(), b.number()) else { return Ok(None) };
                Value::Int(a.total_cmp(&b) as i32)
            }
            ("max" | "min" | "signum", _) if matches!(class, "Integer" | "Long") => {
                let value = self.math(name, arguments)?;
                return Ok(value
                    .map(|rounded| rounded.cast_to(&primitive("int")))
                    .filter(|_| class == "Integer"));
            }
            ("max" | "min", [Value::Double(_), Value::Double(_)]) if class == "Double" => {
                return self.math(name, arguments);
            }
            ("sum", [a, b]) => {
                let [a, b] = [a, b].map(|operand| operand.clone().cast_to(&primitive(unboxed)));
                self.binary(crate::syntax::BinaryOperator::Add, &a, &b)?
            }
            ("toUpperCase", [Value::Char(code @ 0..128)]) => {
                Value::Char(u16::from(letter(*code).to_ascii_uppercase() as u8))
            }
            ("toLowerCase", [Value::Char(code @ 0..128)]) => {
                Value::Char(u16::from(letter(*code).to_ascii_lowercase() as u8))
            }
            ("isUpperCase", [Value::Char(code @ 0..128)]) => {
                Value::Boolean(letter(*code).is_ascii_uppercase())
            }
            ("isLowerCase", [Value::Char(code @ 0..128)]) => {
                Value::Boolean(letter(*code).is_ascii_lowercase())
            }
            ("isLetterOrDigit", [Value::Char(code @ 0..128)]) => {
                Value::Boolean(letter(*code).is_ascii_alphanumeric())
            }
            ("isInfinite", [value]) => Value::Boolean(value.number().is_some_and(f64::is_infinite)),
            ("isFinite", [value]) => Value::Boolean(value.number().is_some_and(f64::is_finite)),
            ("isNaN", [value]) => Value::Boolean(value.number().is_some_and(f64::is_nan)),
            ("toHexString", [Value::Int(value)]) => Value::text(format!("{value:x}")),
            ("toBinaryString", [Value::Int(value)]) => Value::text(format!("{value:b}")),
            ("isDigit", [Value::Char(code)]) if *code < 256 => {
                Value::Boolean(letter(*code).is_ascii_digit())
            }
            ("isLetter", [Value::Char(code)]) if *code < 256 => {
                Value::Boolean(letter(*code).is_alphabetic())
            }
            ("getNumericValue", [Value::Char(code)]) => {
                let digit = letter(*code).to_digit(36);
                Value::Int(digit.and_then(|digit| i32::try_from(digit).ok()).unwrap_or(-1))
            }
            _ => return Ok(None),
        }))
    }

    fn parsed(&mut self, wanted: &str, text: &str) -> Result<Value, EvaluationStop> {
        let value = match wanted {
            "boolean" => Some(Value::Boolean(text.eq_ignore_ascii_case("true"))),
            "double" | "float" => {
                let digits = text.trim();
                if digits.contains(['x', 'X']) {
                    return Ok(self.unknown("a hexadecimal number with an exponent"));
                }
                let digits = digits.strip_suffix(['d', 'D', 'f', 'F']).unwrap_or(digits);
                let is_number = digits.chars().all(|c| c.is_ascii_digit() || ".eE+-".contains(c));
                match digits.trim_start_matches(['+', '-']) {
                    "NaN" | "Infinity" if digits == text.trim() => {}
                    _ if !is_number => return self.no_number(text),
                    _ => {}
                }
                match wanted {
                    "double" => digits.parse().ok().map(Value::Double),
                    _ => digits.parse().ok().map(Value::Float),
                }
            }
            "long" => text.parse().ok().map(Value::Long),
            "short" => text.parse::<i16>().ok().map(|value| Value::Int(i32::from(value))),
            "byte" => text.parse::<i8>().ok().map(|value| Value::Int(i32::from(value))),
            _ => text.parse().ok().map(Value::Int),
        };
        match value {
            Some(value) => Ok(value),
            None => self.no_number(text),
        }
    }

    fn no_number<T>(&self, text: &str) -> Result<T, EvaluationStop> {
        self.throw("NumberFormatException", format!("For input string: \"{text}\""))
    }
}

pub(crate) fn primitive(name: &str) -> TypeName {
    TypeName::new(name, 0)
}

fn letter(code: u16) -> char {
    char::from_u32(u32::from(code)).unwrap_or('\u{fffd}')
}
