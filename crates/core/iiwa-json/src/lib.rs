//! Parsing of JSON that people write: errors with their place in the text and a correction,
//! documents with a version, lists of numbers and of tagged objects. The crate is independent of
//! robots.
//!
//! ```
//! use iiwa_json::{JsonObject, JsonPlace, problem};
//! use serde::Deserialize;
//!
//! #[derive(Debug, Deserialize)]
//! struct Table {
//!     height_mm: f64,
//! }
//!
//! let text = "{ \"height_mm\": \"720\" }";
//! let error = serde_json::from_str::<JsonObject<Table>>(text).unwrap_err();
//! assert_eq!(problem(&error), "expected a number, found string \"720\"");
//! assert_eq!(JsonPlace::of_error(text, text, &error).to_string(), "line 1, column 16");
//! ```

mod encoding;
mod excerpt;
mod fields;
mod locate;
mod meant;
mod place;
mod problem;
mod records;
mod repeated_key;
mod table_header;
mod text_lines;
mod token;
mod values;

#[cfg(test)]
mod tests;

pub use encoding::{UTF_16, bytes_without_mark, is_utf16, without_mark};
pub use excerpt::{excerpt, further_errors, printable};
pub use locate::{JsonStep, element_at, locate};
pub use meant::{are_known, meant, unknown};
pub use place::JsonPlace;
pub use problem::problem;
pub use records::{RecordColumn, Records};
pub use repeated_key::repeated_key;
pub use table_header::{HeaderFault, HeaderSearch, TableHeader, TableLine};
pub use text_lines::{TextLine, TextLines};
pub use values::{
    JsonObject, Numbers, Unread, numbers, object, object_or_null, object_or_null_like,
    read_version, tag,
};
