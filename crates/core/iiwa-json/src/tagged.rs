//! Lists of objects that say in their key `type` what they are.

use std::borrow::Cow;

use serde::Deserialize;

use crate::object::Object;

/// The value of an object's key `type`; none if it has none. With it, the reader knows what to read the
/// object as, and its errors keep their places, which those of serde's own tagged enumerations lose.
///
/// ```
/// let tag = iiwa_json::tag(r#"{ "type": "wait", "seconds": 0.5 }"#)?;
/// assert_eq!(tag.as_deref(), Some("wait"));
/// # Ok::<(), serde_json::Error>(())
/// ```
///
/// # Errors
///
/// If the text is no object, or its `type` no string.
pub fn tag(text: &str) -> Result<Option<Cow<'_, str>>, serde_json::Error> {
    #[derive(Deserialize)]
    struct Tag<'a> {
        #[serde(borrow)]
        r#type: Option<Cow<'a, str>>,
    }
    serde_json::from_str::<Object<Tag<'_>>>(text).map(|tag| tag.0.r#type)
}
