//! Evaluation of `String.format`.

use std::rc::Rc;

use crate::{
    machine::Machine,
    stop::EvaluationStop,
    text::{JavaText, double},
    value::Value,
};

/// Maximum width: wider texts would only fill memory.
const MAX_WIDTH: usize = 1000;

/// Options between `%` and the conversion letter.
struct Options<'o> {
    flags: &'o str,
    width: usize,
    precision: Option<usize>,
}

impl<'o> Options<'o> {
    fn new(written: &'o str) -> Self {
        let (width, precision) = written.split_once('.').unwrap_or((written, ""));
        let digits = width.trim_start_matches(|c| "-+0 ,#(".contains(c));
        Self {
            flags: &width[..width.len() - digits.len()],
            width: digits.parse::<usize>().unwrap_or(0).min(MAX_WIDTH),
            precision: precision.parse::<usize>().ok().map(|digits| digits.min(MAX_WIDTH)),
        }
    }

    fn has(&self, flag: char) -> bool {
        self.flags.contains(flag)
    }

    /// Formats a number from its sign and digits, according to the flags.
    fn number(&self, is_negative: bool, digits: &str) -> String {
        let digits = if self.has(',') { grouped(digits) } else { digits.to_owned() };
        let (before, behind) = match is_negative {
            true if self.has('(') => ("(", ")"),
            true => ("-", ""),
            false if self.has('+') => ("+", ""),
            false if self.has(' ') => (" ", ""),
            false => ("", ""),
        };
        let length = before.len() + digits.chars().count() + behind.len();
        let zeros = if self.has('0') { self.width.saturating_sub(length) } else { 0 };
        format!("{before}{}{digits}{behind}", "0".repeat(zeros))
    }

    fn padded(&self, text: &str) -> String {
        let missing = " ".repeat(self.width.saturating_sub(text.chars().count()));
        if self.has('-') { format!("{text}{missing}") } else { format!("{missing}{text}") }
    }
}

impl Machine {
    /// Evaluates `String.format`; unsupported conversions are refused.
    pub(crate) fn formatted(
        &mut self,
        format: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let mut text = String::new();
        let mut next = 0;
        let mut rest = format.chars().peekable();
        while let Some(letter) = rest.next() {
            if letter != '%' {
                text.push(letter);
                continue;
            }
            let mut options = String::new();
            while let Some(option) = rest.next_if(|c| !c.is_ascii_alphabetic() && *c != '%') {
                options.push(option);
            }
            let conversion = rest.next().unwrap_or('%');
            if conversion == '%' || conversion == 'n' {
                text.push(if conversion == 'n' { '\n' } else { '%' });
                continue;
            }
            let index = if let Some((index, others)) = options.split_once('$') {
                let index = index.parse::<usize>().unwrap_or(0);
                options = others.to_owned();
                index.wrapping_sub(1)
            } else {
                next += 1;
                next - 1
            };
            let Some(value) = arguments.get(index) else {
                return self.throw("MissingFormatArgumentException", format);
            };
            match self.formatted_value(conversion, &options, value)? {
                Ok(converted) => text.push_str(&converted),
                Err(unknown) => return Ok(Value::Unknown(unknown)),
            }
        }
        Ok(Value::text(text))
    }

    fn formatted_value(
        &mut self,
        conversion: char,
        written: &str,
        value: &Value,
    ) -> Result<JavaText, EvaluationStop> {
        let options = Options::new(written);
        if let Value::Unknown(unknown) = value {
            return Ok(Err(Rc::clone(unknown)));
        }
        let plain = match (conversion.to_ascii_lowercase(), value) {
            ('d', Value::Int(_) | Value::Long(_)) => {
                let number = value.integer().unwrap_or_default();
                options.number(number < 0, &number.unsigned_abs().to_string())
            }
            ('x', Value::Int(number)) if i16::try_from(*number).is_ok() && *number < 0 => {
                let unknown = self.unknown("whether a negative number is a `byte` or an `int`");
                return Ok(unknown
                    .unknown()
                    .map_or_else(|| Ok(String::new()), |unknown| Err(Rc::clone(unknown))));
            }
            ('x', Value::Int(_) | Value::Long(_)) => {
                let digits = match value {
                    Value::Int(number) => format!("{number:x}"),
                    _ => format!("{:x}", value.integer().unwrap_or_default()),
                };
                let before = if options.has('#') { "0x" } else { "" };
                let length = before.len() + digits.len();
                let zeros = if options.has('0') { options.width.saturating_sub(length) } else { 0 };
                format!("{before}{}{digits}", "0".repeat(zeros))
            }
            ('f', Value::Double(_) | Value::Float(_)) => {
                let number = value.number().unwrap_or_default();
                if number.is_finite() {
                    let digits = fixed(number.abs(), options.precision.unwrap_or(6));
                    options.number(number.is_sign_negative(), &digits)
                } else {
                    double(number)
                }
            }
            ('b', _) => match value {
                Value::Null => "false".to_owned(),
                Value::Boolean(value) => value.to_string(),
                _ => "true".to_owned(),
            },
            ('c', Value::Char(_)) | ('s', _) => match self.text_of(value)? {
                Ok(text) => match options.precision {
                    Some(digits) => text.chars().take(digits).collect(),
                    None => text,
                },
                Err(unknown) => return Ok(Err(unknown)),
            },
            ('c', Value::Int(code)) => {
                let letter = u32::try_from(*code).ok().and_then(char::from_u32);
                letter.unwrap_or('\u{fffd}').to_string()
            }
            _ => {
                return self.reject(format!(
                    "the format %{written}{conversion} for {} is not known",
                    value.kind()
                ));
            }
        };
        let plain = if conversion.is_ascii_uppercase() { plain.to_uppercase() } else { plain };
        Ok(Ok(options.padded(&plain)))
    }
}

/// Formats a non-negative number with decimal digits. Java rounds its shortest decimal
/// representation half up: 2.675 becomes 2.68.
fn fixed(value: f64, precision: usize) -> String {
    let written = format!("{value:e}");
    let (digits, exponent) = written.split_once('e').unwrap_or((&written, "0"));
    let mut digits: Vec<u8> = digits.bytes().filter(u8::is_ascii_digit).map(|d| d - b'0').collect();
    // Number of digits before the decimal point.
    let mut before = exponent.parse::<isize>().unwrap_or(0) + 1;
    if before < 1 {
        let zeros = usize::try_from(1 - before).unwrap_or(0).min(MAX_WIDTH + 2);
        digits.splice(0..0, std::iter::repeat_n(0, zeros));
        before = 1;
    }
    let mut point = usize::try_from(before).unwrap_or(1);
    let kept = point + precision;
    let rounds_up = digits.get(kept).is_some_and(|digit| *digit >= 5);
    digits.resize(kept, 0);
    if rounds_up {
        let last = digits.iter().rposition(|digit| *digit < 9);
        let from = last.map_or(0, |last| last + 1);
        digits[from..].fill(0);
        if let Some(last) = last {
            digits[last] += 1;
        } else {
            digits.insert(0, 1);
            point += 1;
        }
    }
    let mut text: String = digits.iter().map(|digit| char::from(b'0' + digit)).collect();
    if precision > 0 {
        text.insert(point, '.');
    }
    text
}

/// Groups the digits before the decimal point by three.
fn grouped(digits: &str) -> String {
    let (whole, rest) = digits.split_at(digits.find('.').unwrap_or(digits.len()));
    let mut text = String::new();
    for (place, digit) in whole.chars().enumerate() {
        if place > 0 && (whole.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text + rest
}
