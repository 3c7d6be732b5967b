//! Values read strictly: objects by their `version` or `type`, and lists of so many numbers. serde
//! alone also reads a list as an object, and does not say what a list is of.

use std::{borrow::Cow, fmt, marker::PhantomData};

use serde::{
    Deserialize, Deserializer, Serialize,
    de::{Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer},
};

use crate::{
    locate::{JsonStep, locate},
    place::JsonPlace,
};

/// A structure written as a JSON object. By default, serde also accepts a list with the values in
/// the order of the fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct JsonObject<T>(pub T);

/// Visitor that reads a `T` from an object only; `like` describes it for errors.
struct OfMap<T> {
    like: &'static str,
    of: PhantomData<T>,
}

impl<T> OfMap<T> {
    const fn new(like: &'static str) -> Self {
        Self { like, of: PhantomData }
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for OfMap<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.like)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map))
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for JsonObject<T> {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        reader.deserialize_map(OfMap::new("an object")).map(Self)
    }
}

/// Reads a field that is an object, for `deserialize_with`.
///
/// # Errors
///
/// If the value is something else, or not the expected object.
pub fn object<'de, T: Deserialize<'de>, D: Deserializer<'de>>(reader: D) -> Result<T, D::Error> {
    JsonObject::deserialize(reader).map(|object| object.0)
}

/// Reads a field that is an object or null, for `deserialize_with`.
///
/// # Errors
///
/// As [`object`].
pub fn object_or_null<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    reader: D,
) -> Result<Option<T>, D::Error> {
    let object = Option::<JsonObject<T>>::deserialize(reader)?;
    Ok(object.map(|object| object.0))
}

/// Reads an object or null; `like` describes the expected value for errors, for example by an
/// example.
///
/// # Errors
///
/// As [`object`].
pub fn object_or_null_like<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    reader: D,
    like: &'static str,
) -> Result<Option<T>, D::Error> {
    struct OrNull<T>(OfMap<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for OrNull<T> {
        type Value = Option<T>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            self.0.expecting(f)
        }

        fn visit_unit<E>(self) -> Result<Option<T>, E> {
            Ok(None)
        }

        fn visit_none<E>(self) -> Result<Option<T>, E> {
            Ok(None)
        }

        fn visit_some<D: Deserializer<'de>>(self, reader: D) -> Result<Option<T>, D::Error> {
            reader.deserialize_map(self.0).map(Some)
        }
    }
    reader.deserialize_option(OrNull(OfMap::new(like)))
}

/// Value of an object's key `type`; `None` if absent. The reader can then choose the type to read,
/// and its errors keep their places, which serde's own tagged enumerations lose.
///
/// ```
/// let tag = iiwa_json::tag(r#"{ "type": "wait", "seconds": 0.5 }"#)?;
/// assert_eq!(tag.as_deref(), Some("wait"));
/// # Ok::<(), serde_json::Error>(())
/// ```
///
/// # Errors
///
/// If the text is not an object, or its `type` is not a string.
pub fn tag(text: &str) -> Result<Option<Cow<'_, str>>, serde_json::Error> {
    #[derive(Deserialize)]
    struct TypeTag<'a> {
        #[serde(borrow)]
        r#type: Option<Cow<'a, str>>,
    }
    serde_json::from_str::<JsonObject<TypeTag<'_>>>(text).map(|tag| tag.0.r#type)
}

/// Error: a text of a versioned format was not read.
#[derive(Debug)]
pub enum Unread {
    /// The text has another version.
    Version {
        /// Version found.
        found: u64,
        /// Place in the text.
        place: JsonPlace,
    },
    /// The text is not JSON, or not the expected JSON.
    Json(serde_json::Error),
}

/// Reads an object of a `version`, given by its key `version`; `of` gets the version from the
/// result. Because another version may have other keys, a wrong version takes precedence over other
/// errors.
///
/// # Errors
///
/// [`Unread`].
pub fn read_version<'a, T: Deserialize<'a>>(
    text: &'a str,
    version: u64,
    of: impl FnOnce(&T) -> u64,
) -> Result<T, Unread> {
    #[derive(Deserialize)]
    struct VersionOnly {
        version: Option<u64>,
    }
    let other = |found: Option<u64>| {
        let found = found.filter(|found| *found != version)?;
        Some(Unread::Version { found, place: locate(text, &[JsonStep::Key("version")]) })
    };
    match serde_json::from_str::<JsonObject<T>>(text) {
        Ok(JsonObject(read)) => other(Some(of(&read))).map_or(Ok(read), Err),
        Err(error) => {
            let only = serde_json::from_str::<JsonObject<VersionOnly>>(text).ok();
            Err(only.and_then(|only| other(only.0.version)).unwrap_or(Unread::Json(error)))
        }
    }
}

/// Reads exactly `N` numbers; `expected` describes them for errors, such as "three numbers, for x,
/// y and z".
///
/// ```
/// use iiwa_json::numbers;
///
/// let mut reader = serde_json::Deserializer::from_str("[1, 2.5]");
/// let error = numbers::<3, _>(&mut reader, "three numbers, for x, y and z").unwrap_err();
/// assert!(error.to_string().contains("expected three numbers"));
/// ```
///
/// # Errors
///
/// If the value is not a list of numbers, or has another length.
pub fn numbers<'de, const N: usize, D: Deserializer<'de>>(
    reader: D,
    expected: &'static str,
) -> Result<[f64; N], D::Error> {
    reader.deserialize_seq(Numbers(expected))
}

/// The visitor of [`numbers`], for fields that may be something else as well.
#[derive(Clone, Copy, Debug)]
pub struct Numbers<const N: usize>(
    /// Description of the expected numbers.
    pub &'static str,
);

impl<'de, const N: usize> Visitor<'de> for Numbers<N> {
    type Value = [f64; N];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut numbers = [0.0; N];
        let mut count = 0;
        while count < N {
            let Some(value) = seq.next_element()? else { break };
            numbers[count] = value;
            count += 1;
        }
        while count >= N && seq.next_element::<IgnoredAny>()?.is_some() {
            count += 1;
        }
        if count == N { Ok(numbers) } else { Err(A::Error::invalid_length(count, &self)) }
    }
}
