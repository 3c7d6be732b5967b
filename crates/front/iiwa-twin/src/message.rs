//! Messages to pages: JSON objects; the latest of each kind is kept.

use std::sync::Arc;

use serde::Serialize;
use tokio::sync::watch;

/// JSON object with one field, such as `{"live": ...}`.
pub(crate) type PageMessage = Arc<str>;

/// Channel that holds the latest message of a kind, and passes it on to all pages.
pub(crate) type PageChannel = watch::Sender<PageMessage>;

/// Creates a message of one kind.
pub(crate) fn page_message(kind: &str, value: &impl Serialize) -> PageMessage {
    // Numbers, texts and lists can always be serialised.
    let value = serde_json::to_string(value).unwrap_or_else(|_| "null".to_owned());
    format!("{{\"{kind}\":{value}}}").into()
}
