//! Values as text, as Java writes them.

use std::{fmt::Write as _, rc::Rc};

use crate::{
    machine::Machine,
    stop::Stop,
    unknown::Unknown,
    value::{MapPart, Value},
};

/// A text, or what it depends on.
pub(crate) type Text = Result<String, Rc<Unknown>>;

/// Levels of collections within collections that are written.
const MAX_NESTING: usize = 20;

/// `Double.toString`.
pub(crate) fn double(value: f64) -> String {
    if value.is_nan() {
        return "NaN".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "Infinity" } else { "-Infinity" }.to_owned();
    }
    with_point(value.abs(), format!("{value:?}"), format!("{value:E}"))
}

/// `Float.toString`.
pub(crate) fn float(value: f32) -> String {
    if !value.is_finite() {
        return double(f64::from(value));
    }
    with_point(f64::from(value.abs()), format!("{value:?}"), format!("{value:E}"))
}

/// Java has digits from 1e-3 to 1e7, and an exponent outside, both with a point.
fn with_point(size: f64, plain: String, with_exponent: String) -> String {
    if size == 0.0 || (1e-3..1e7).contains(&size) {
        return plain;
    }
    match with_exponent.split_once('E') {
        Some((digits, exponent)) if !digits.contains('.') => format!("{digits}.0E{exponent}"),
        _ => with_exponent,
    }
}

impl Machine {
    /// What a string holds of a value when it is appended.
    pub(crate) fn text_of(&mut self, value: &Value) -> Result<Text, Stop> {
        self.text_within(value, 0)
    }

    fn text_within(&mut self, value: &Value, depth: usize) -> Result<Text, Stop> {
        if depth > MAX_NESTING {
            return self.refuse("collections are nested too deeply to be written as text");
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
                    None => self.java.classes.known(object.class).class.name.clone(),
                }
            }
            Value::Exception(thrown) => {
                let class = thrown.classes.first().map_or("Exception", |class| class);
                format!("{class}: {}", thrown.message)
            }
            Value::Class(id) => format!("class {}", self.java.classes.known(*id).class.name),
            Value::ForeignClass(name) => format!("class {name}"),
            Value::Host(value) => self.host.text(value),
            Value::Array(array) => format!("{}[]", array.element.name),
            Value::Iterator(_) => "iterator".to_owned(),
            Value::Unknown(unknown) => return Ok(Err(Rc::clone(unknown))),
        }))
    }

    /// `[a, b]`.
    fn listed(&mut self, values: &[Value], depth: usize) -> Result<Text, Stop> {
        let mut texts = Vec::new();
        for value in values {
            match self.text_within(value, depth + 1)? {
                Ok(text) => texts.push(text),
                Err(unknown) => return Ok(Err(unknown)),
            }
        }
        Ok(Ok(format!("[{}]", texts.join(", "))))
    }

    /// `Arrays.toString`, `[a, b]`.
    pub(crate) fn text_of_elements(&mut self, values: &[Value]) -> Result<Text, Stop> {
        self.listed(values, 0)
    }

    /// `String.format`; conversions that are not known are refused.
    pub(crate) fn formatted(&mut self, format: &str, arguments: &[Value]) -> Result<Value, Stop> {
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
            let converted = match self.formatted_value(conversion, &options, value)? {
                Ok(converted) => converted,
                Err(unknown) => return Ok(Value::Unknown(unknown)),
            };
            text.push_str(&converted);
        }
        Ok(Value::text(text))
    }

    fn formatted_value(
        &mut self,
        conversion: char,
        options: &str,
        value: &Value,
    ) -> Result<Text, Stop> {
        /// Wider ones would only fill memory.
        const MAX_WIDTH: usize = 1000;
        let (width, precision) = options.split_once('.').unwrap_or((options, ""));
        let flags: String = width.chars().take_while(|c| "-+0 ,#(".contains(*c)).collect();
        let width = width[flags.len()..].parse::<usize>().unwrap_or(0).min(MAX_WIDTH);
        let precision = precision.parse::<usize>().ok().map(|digits| digits.min(MAX_WIDTH));
        let plus = if flags.contains('+') { "+" } else { "" };
        let signed = |text: String| {
            if text.starts_with('-') { text } else { format!("{plus}{text}") }
        };
        let plain = match (conversion, value) {
            (_, Value::Unknown(unknown)) => return Ok(Err(Rc::clone(unknown))),
            ('d', _) if value.integer().is_some() => {
                signed(value.integer().unwrap_or_default().to_string())
            }
            ('x', Value::Int(value)) => format!("{value:x}"),
            ('X', Value::Int(value)) => format!("{value:X}"),
            ('x', Value::Long(value)) => format!("{value:x}"),
            ('f', Value::Double(_) | Value::Float(_)) => {
                let number = value.number().unwrap_or_default();
                signed(format!("{number:.*}", precision.unwrap_or(6)))
            }
            ('s' | 'S' | 'b' | 'c', _) => match self.text_of(value)? {
                Ok(text) => match precision {
                    Some(digits) => text.chars().take(digits).collect(),
                    None => text,
                },
                Err(unknown) => return Ok(Err(unknown)),
            },
            _ => {
                return self.refuse(format!(
                    "the format %{options}{conversion} for {} is not known",
                    value.kind()
                ));
            }
        };
        let missing = width.saturating_sub(plain.chars().count());
        Ok(Ok(if flags.contains('-') {
            plain + &" ".repeat(missing)
        } else if flags.contains('0') {
            let (sign, digits) = plain.split_at(usize::from(plain.starts_with(['-', '+'])));
            format!("{sign}{}{digits}", "0".repeat(missing))
        } else {
            " ".repeat(missing) + &plain
        }))
    }
}
