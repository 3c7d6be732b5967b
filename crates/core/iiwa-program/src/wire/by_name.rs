//! Objects with names as keys, and string enumerations.

use std::{collections::BTreeMap, fmt, marker::PhantomData};

use iiwa_json::{JsonObject, excerpt};
use serde::{
    Deserialize, Deserializer,
    de::{Error, IntoDeserializer, MapAccess, Visitor, value::StringDeserializer},
};

/// Reads an object of objects by name. By default, serde would keep the last of two entries with
/// the same name, and accept arrays as objects.
pub(super) fn by_name<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    reader: D,
) -> Result<BTreeMap<String, T>, D::Error> {
    struct ByNameVisitor<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for ByNameVisitor<T> {
        type Value = BTreeMap<String, T>;
        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("an object, by names")
        }
        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut all = BTreeMap::new();
            while let Some(name) = map.next_key::<String>()? {
                let JsonObject(value) = map.next_value()?;
                if all.contains_key(&name) {
                    let message = format!("the name `{}` appears twice", excerpt(&name));
                    return Err(A::Error::custom(message));
                }
                all.insert(name, value);
            }
            Ok(all)
        }
    }
    reader.deserialize_map(ByNameVisitor(PhantomData))
}

/// Reads one of a few words. For anything but a string, serde's JSON reader would otherwise report
/// invalid JSON.
pub(super) fn word<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    reader: D,
) -> Result<T, D::Error> {
    let text: StringDeserializer<D::Error> = String::deserialize(reader)?.into_deserializer();
    T::deserialize(text)
}

/// Reads one of a few words, or null.
pub(super) fn word_or_null<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    reader: D,
) -> Result<Option<T>, D::Error> {
    let Some(text) = Option::<String>::deserialize(reader)? else { return Ok(None) };
    let text: StringDeserializer<D::Error> = text.into_deserializer();
    T::deserialize(text).map(Some)
}
