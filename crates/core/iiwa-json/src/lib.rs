//! JSON written by people: errors with their place in the text and a correction, documents with a
//! version, lists of numbers and of tagged objects. Independent of robots.
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

mod excerpt;
mod list;
mod locate;
mod meant;
mod object;
mod place;
mod printable;
mod problem;
mod records;
mod tagged;
mod token;
mod version;

#[cfg(test)]
mod tests;

pub use excerpt::excerpt;
pub use list::{Numbers, numbers};
pub use locate::{JsonStep, element_at, locate};
pub use meant::{are_known, meant, unknown};
pub use object::{JsonObject, object, object_or_null, object_or_null_like};
pub use place::JsonPlace;
pub use printable::printable;
pub use problem::problem;
pub use records::Records;
pub use tagged::tag;
pub use version::{Unread, read_version};
