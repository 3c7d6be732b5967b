//! Elements of an XML text.

use std::ops::Range;

use iiwa_json::JsonPlace;
use quick_xml::{
    Reader,
    events::{BytesStart, Event},
};

use crate::error::DataFileError;

/// Maximum nesting depth of elements: code that recurses into the elements needs stack for each
/// level.
const MAX_DEPTH: usize = 100;

/// Element with its content.
pub(crate) struct Element<'t> {
    pub(crate) name: String,
    attributes: Vec<(String, String)>,
    pub(crate) children: Vec<Element<'t>>,
    /// Text directly in the element.
    words: String,
    text: &'t str,
    /// Byte range of the start tag.
    span: Range<usize>,
}

impl<'t> Element<'t> {
    /// Reads the outermost element of a text. Comments and processing instructions are skipped.
    pub(crate) fn read(text: &'t str) -> Result<Self, DataFileError> {
        let fail = |span: Range<usize>, problem: String| DataFileError::Xml {
            place: JsonPlace::of_span(text, span),
            problem,
        };
        let mut reader = Reader::from_str(text);
        let mut open: Vec<Self> = Vec::new();
        let mut outermost: Option<Self> = None;
        loop {
            let start = offset(reader.buffer_position());
            let event = reader.read_event().map_err(|error| {
                let byte = offset(reader.error_position());
                fail(byte..byte + 1, error.to_string())
            })?;
            let span = start..offset(reader.buffer_position());
            let closed = match event {
                Event::Start(tag) => {
                    if open.len() == MAX_DEPTH {
                        let problem = format!("elements are nested more than {MAX_DEPTH} deep");
                        return Err(fail(span, problem));
                    }
                    open.push(Self::of_tag(text, span.clone(), &tag)?);
                    None
                }
                Event::Empty(tag) => Some(Self::of_tag(text, span.clone(), &tag)?),
                Event::End(_) => open.pop(),
                Event::Text(words) => {
                    if let (Some(inner), Ok(words)) = (open.last_mut(), words.decode()) {
                        inner.words.push_str(&words);
                    }
                    None
                }
                Event::Eof => {
                    return match (open.last(), outermost) {
                        (Some(inner), _) => {
                            let problem = format!("it ends inside <{}>", inner.name);
                            Err(fail(text.len()..text.len(), problem))
                        }
                        (None, None) => Err(fail(0..0, "it has no element".to_owned())),
                        (None, Some(outermost)) => Ok(outermost),
                    };
                }
                _ => None,
            };
            let Some(closed) = closed else { continue };
            match open.last_mut() {
                Some(parent) => parent.children.push(closed),
                None if outermost.is_some() => {
                    return Err(fail(closed.span, "it has a second outermost element".to_owned()));
                }
                None => outermost = Some(closed),
            }
        }
    }

    fn of_tag(
        text: &'t str,
        span: Range<usize>,
        tag: &BytesStart<'_>,
    ) -> Result<Self, DataFileError> {
        let fail = |problem: String| DataFileError::Xml {
            place: JsonPlace::of_span(text, span.clone()),
            problem,
        };
        let name = String::from_utf8_lossy(tag.name().as_ref()).into_owned();
        let mut attributes = Vec::new();
        // The library's own search for duplicate attributes takes quadratic time.
        for attribute in tag.attributes().with_checks(false) {
            let attribute = attribute.map_err(|error| fail(error.to_string()))?;
            let value = attribute
                .decode_and_unescape_value(tag.decoder())
                .map_err(|error| fail(error.to_string()))?;
            let key = String::from_utf8_lossy(attribute.key.as_ref()).into_owned();
            attributes.push((key, value.into_owned()));
        }
        Ok(Self { name, attributes, children: Vec::new(), words: String::new(), text, span })
    }

    pub(crate) fn place(&self) -> JsonPlace {
        JsonPlace::of_span(self.text, self.span.clone())
    }

    /// Returns the text directly in the element, without the text of its children.
    pub(crate) fn words(&self) -> &str {
        &self.words
    }

    pub(crate) fn attribute(&self, name: &str) -> Option<&str> {
        let (_, value) = self.attributes.iter().find(|(key, _)| key == name)?;
        Some(value)
    }

    pub(crate) fn required(&self, name: &'static str) -> Result<&str, DataFileError> {
        self.attribute(name).ok_or_else(|| self.missing(name))
    }

    pub(crate) fn missing(&self, missing: &'static str) -> DataFileError {
        DataFileError::Missing { place: self.place(), owner: self.name.clone(), missing }
    }

    pub(crate) fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.name == name)
    }

    /// Returns an attribute as a finite number.
    pub(crate) fn number(&self, name: &'static str) -> Result<f64, DataFileError> {
        let text = self.required(name)?;
        text.trim().parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| {
            DataFileError::Number {
                place: self.place(),
                attribute: name.to_owned(),
                text: text.chars().take(80).collect(),
            }
        })
    }
}

fn offset(byte: u64) -> usize {
    usize::try_from(byte).unwrap_or(usize::MAX)
}
