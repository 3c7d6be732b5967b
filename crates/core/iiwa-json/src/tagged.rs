//! Lists of objects whose key `type` gives their type.

use std::borrow::Cow;

use serde::Deserialize;

use crate::object::JsonObject;

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
