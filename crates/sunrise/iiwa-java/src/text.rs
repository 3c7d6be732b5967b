//! Values as text, in Java's format.

use std::{
    fmt::{Debug, Display, UpperExp, Write as _},
    rc::Rc,
    str::FromStr,
};

use crate::{
    machine::Machine,
    stop::EvaluationStop,
    syntax::ClassKind,
    unknown::Unknown,
    value::{JavaObject, MapPart, Value},
    variables::fields,
};

/// Text, or the unknown value that it depends on.
pub(crate) type JavaText = Result<String, Rc<Unknown>>;

/// Maximum nesting depth of collections in a text.
const MAX_NESTING: usize = 20;

/// Exceptions whose package is known.
const OF_JAVA_LANG: [&str; 10] = [
    "ArithmeticException",
    "ArrayIndexOutOfBoundsException",
    "ClassCastException",
    "Exception",
    "IllegalArgumentException",
    "IllegalStateException",
    "IndexOutOfBoundsException",
    "NullPointerException",
    "NumberFormatException",
    "RuntimeException",
];

/// Evaluates `Double.toString`.
pub(crate) fn double(value: f64) -> String {
    if value.is_nan() {
        return "NaN".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "Infinity" } else { "-Infinity" }.to_owned();
    }
    let [plain, exponent] = shortest(value);
    with_point(value, f64::MANTISSA_DIGITS, plain, exponent)
}

/// Evaluates `Float.toString`.
pub(crate) fn float(value: f32) -> String {
    if !value.is_finite() {
        return double(f64::from(value));
    }
    let [plain, exponent] = shortest(value);
    with_point(f64::from(value), f32::MANTISSA_DIGITS, plain, exponent)
}

/// Returns the shortest texts that are read back to a number, without and with an exponent; the
/// nearest among equally short ones.
fn shortest<T>(value: T) -> [String; 2]
where
    T: Copy + Debug + Display + UpperExp + FromStr + PartialEq,
{
    let plain = format!("{value:?}");
    let exponent = format!("{value:E}");
    let nearest =
        [format!("{value:.*}", decimals(&plain)), format!("{value:.*E}", decimals(&exponent))];
    let is_same = |text: &str| text.parse().is_ok_and(|read: T| read == value);
    let [nearest_plain, nearest_exponent] = nearest;
    [
        if is_same(&nearest_plain) { nearest_plain } else { plain },
        if is_same(&nearest_exponent) { nearest_exponent } else { exponent },
    ]
}

/// Returns the number of digits after the decimal point, at least one in Java.
fn decimals(text: &str) -> usize {
    let digits = text.split_once('.').map_or("", |(_, behind)| behind);
    digits.find('E').unwrap_or(digits.len()).max(1)
}

/// Formats a number as Java does: without an exponent from 1e-3 to 1e7, otherwise with one, and
/// always with a decimal point. The digits are the shortest ones, and the nearest to the number
/// among these: at least two, 4.9E-324 and not 5E-324. Up to Java 18, as on controllers, large
/// integers keep more digits; the few other texts of these versions that are longer than needed,
/// such as that of 1e23, are not reproduced.
fn with_point(value: f64, significant_bits: u32, plain: String, with_exponent: String) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-3..1e7).contains(&size) {
        return plain;
    }
    if let Some(digits) = whole(size, significant_bits) {
        let sign = if value < 0.0 { "-" } else { "" };
        return format!("{sign}{digits}");
    }
    if with_exponent.contains('.') { with_exponent } else { with_exponent.replacen('E', ".0E", 1) }
}

/// Formats an integer of at least 1e7 and below 2^63, without the digits beyond the precision of
/// its type.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 64 bits")]
fn whole(size: f64, significant_bits: u32) -> Option<String> {
    if size.fract() != 0.0 || !(1e7..9_223_372_036_854_775_808.0).contains(&size) {
        return None;
    }
    let mut number = size as u64;
    let surplus_bits = number.ilog2().saturating_sub(significant_bits + 1);
    let dropped = (1_u64 << surplus_bits).ilog10();
    let unit = 10_u64.pow(dropped);
    number = number / unit + u64::from(dropped > 0 && number % unit >= unit / 2);
    let digits = number.to_string();
    let (first, others) = digits.split_at(1);
    let others = others.trim_end_matches('0');
    let others = if others.is_empty() { "0" } else { others };
    let exponent = digits.len() - 1 + dropped as usize;
    Some(format!("{first}.{others}E{exponent}"))
}

impl Machine {
    /// Converts a value to text for string concatenation.
    pub(crate) fn text_of(&mut self, value: &Value) -> Result<JavaText, EvaluationStop> {
        self.text_within(value, 0)
    }

    fn text_within(&mut self, value: &Value, depth: usize) -> Result<JavaText, EvaluationStop> {
        if depth > MAX_NESTING {
            return self.reject("collections are nested too deeply to be written as text");
        }
        Ok(Ok(match value {
            Value::Null => "null".to_owned(),
            Value::Boolean(value) => value.to_string(),
            Value::Char(code) => String::from_utf16_lossy(&[*code]),
            Value::Int(value) => value.to_string(),
            Value::Long(value) => value.to_string(),
            Value::Float(value) => float(*value),
            Value::Double(value) => double(*value),
            Value::Text(text) => text.to_string(),
            Value::Builder(text) => match &*text.borrow() {
                Ok(text) => text.clone(),
                Err(unknown) => return Ok(Err(Rc::clone(unknown))),
            },
            Value::List(list) => {
                self.refresh(value);
                let values = list.borrow().clone();
                return self.listed(&values, depth);
            }
            Value::Cell(value) => {
                let value = value.borrow().clone();
                return self.text_within(&value, depth + 1);
            }
            Value::Map(map) if map.borrow().is_set => {
                return match self.map_part(map, MapPart::Keys) {
                    Ok(values) => self.listed(&values, depth),
                    Err(unknown) => Ok(Err(unknown)),
                };
            }
            Value::Map(map) => {
                let Some(entries) = Self::ordered_entries(map) else {
                    return Ok(self.map_part(map, MapPart::Keys).map(|_| String::new()));
                };
                let mut text = "{".to_owned();
                for (index, (key, value)) in entries.iter().enumerate() {
                    let comma = if index == 0 { "" } else { ", " };
                    let both =
                        (self.text_within(key, depth + 1)?, self.text_within(value, depth + 1)?);
                    match both {
                        (Ok(key), Ok(value)) => _ = write!(text, "{comma}{key}={value}"),
                        (Err(unknown), _) | (_, Err(unknown)) => return Ok(Err(unknown)),
                    }
                }
                text + "}"
            }
            Value::Object(object) => {
                if !self.java.classes.methods(object.class, "toString").is_empty() {
                    let text = self.call_on_object(object, "toString", &[])?;
                    return match text {
                        Value::Object(_) => Ok(Ok("object".to_owned())),
                        other => self.text_within(&other, depth + 1),
                    };
                }
                match &object.constant {
                    Some((name, _)) => name.to_string(),
                    None if self.java.classes.known(object.class).class.kind
                        == ClassKind::Record =>
                    {
                        return self.text_of_record(object, depth);
                    }
                    None => {
                        return Ok(Err(self.no_text("the text of an object without `toString`")));
                    }
                }
            }
            Value::Exception(thrown) => {
                let class = thrown.classes.first().map_or("Exception", |class| class);
                if !OF_JAVA_LANG.contains(&class) {
                    return Ok(Err(self.no_text("the text of an exception")));
                }
                match &thrown.value {
                    Value::Null => format!("java.lang.{class}"),
                    Value::Text(message) => format!("java.lang.{class}: {message}"),
                    _ => return Ok(Err(self.no_text("the message of an exception"))),
                }
            }
            Value::Class(id) => format!("class {}", self.java.classes.known(*id).class.name),
            Value::ForeignClass(name) => format!("class {name}"),
            Value::Host(value) => self.host.text(value),
            Value::Array(_) => return Ok(Err(self.no_text("the text of an array"))),
            Value::Stream(_) | Value::Collector(_) | Value::Optional(_) => {
                return Ok(Err(self.no_text(&format!("the text of {}", value.kind()))));
            }
            Value::Function(function) => {
                return Ok(Err(self.no_text(&format!("the text of {}", function.kind()))));
            }
            Value::Iterator(_) => return Ok(Err(self.no_text("the text of an iterator"))),
            Value::Unknown(unknown) => return Ok(Err(Rc::clone(unknown))),
        }))
    }

    /// Formats a record as `Point[x=1, y=2]`.
    pub(crate) fn text_of_record(
        &mut self,
        object: &Rc<JavaObject>,
        depth: usize,
    ) -> Result<JavaText, EvaluationStop> {
        let class = std::sync::Arc::clone(&self.java.classes.known(object.class).class);
        let mut parts = Vec::new();
        for component in fields(&class.members).filter(|field| !field.is_static) {
            let key = (object.class, component.name.clone());
            let value = object.fields.borrow().get(&key).cloned().unwrap_or(Value::Null);
            match self.text_within(&value, depth + 1)? {
                Ok(text) => parts.push(format!("{}={text}", component.name)),
                Err(unknown) => return Ok(Err(unknown)),
            }
        }
        Ok(Ok(format!("{}[{}]", class.name, parts.join(", "))))
    }

    /// Creates the reason of an unknown text.
    fn no_text(&self, reason: &str) -> Rc<Unknown> {
        Rc::new(Unknown {
            reason: reason.to_owned(),
            place: self.place.clone(),
            is_unmodelled_call: false,
        })
    }

    /// Formats elements as `[a, b]`.
    fn listed(&mut self, values: &[Value], depth: usize) -> Result<JavaText, EvaluationStop> {
        let mut texts = Vec::new();
        for value in values {
            match self.text_within(value, depth + 1)? {
                Ok(text) => texts.push(text),
                Err(unknown) => return Ok(Err(unknown)),
            }
        }
        Ok(Ok(format!("[{}]", texts.join(", "))))
    }

    /// Evaluates `Arrays.toString`, which formats as `[a, b]`.
    pub(crate) fn text_of_elements(
        &mut self,
        values: &[Value],
    ) -> Result<JavaText, EvaluationStop> {
        self.listed(values, 0)
    }
}
