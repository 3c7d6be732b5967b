//! Structures written as objects, also such whose key `type` gives their type.

use std::{borrow::Cow, fmt, marker::PhantomData};

use serde::{
    Deserialize, Deserializer, Serialize,
    de::{MapAccess, Visitor, value::MapAccessDeserializer},
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
