//! The page as HTML.

use crate::{
    failure::Failure,
    page::{self, Part},
};

use super::Page;

/// Parts of this page alone.
const PARTS: [Part; 3] = [
    ("/*data.js*/", include_str!("data.js")),
    ("/*charts.js*/", include_str!("charts.js")),
    ("/*main.js*/", include_str!("main.js")),
];

/// The whole page, with its style, its scripts and its data.
pub(crate) fn html(page: &Page) -> Result<String, Failure> {
    page::assemble(include_str!("page.html"), &PARTS, page.title(), page)
}
