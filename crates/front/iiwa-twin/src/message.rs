//! Messages to pages: JSON objects, of which the latest of each kind is kept.

use std::sync::Arc;

use serde::Serialize;
use tokio::sync::watch;

/// A JSON object with one field, as `{"live": ...}`.
pub(crate) type PageMessage = Arc<str>;

/// Holds the latest message of a kind, and passes it on to all pages.
pub(crate) type PageChannel = watch::Sender<PageMessage>;

/// A message of one kind.
pub(crate) fn page_message(kind: &str, value: &impl Serialize) -> PageMessage {
    // Numbers, texts and lists can always be serialised.
    let value = serde_json::to_string(value).unwrap_or_else(|_| "null".to_owned());
    format!("{{\"{kind}\":{value}}}").into()
}
