//! The page as HTML.

use crate::{failure::Failure, output};

use super::Page;

const PAGE: &str = include_str!("page.html");

/// What stands in [`PAGE`] for a file, and the file.
const PARTS: [(&str, &str); 6] = [
    ("/*style.css*/", include_str!("style.css")),
    ("/*data.js*/", include_str!("data.js")),
    ("/*arm.js*/", include_str!("arm.js")),
    ("/*scene.js*/", include_str!("scene.js")),
    ("/*charts.js*/", include_str!("charts.js")),
    ("/*main.js*/", include_str!("main.js")),
];

/// The whole page, with its style, its scripts and its data.
pub(crate) fn html(page: &Page) -> Result<String, Failure> {
    let html = PARTS.iter().fold(PAGE.to_owned(), |html, (place, part)| html.replace(place, part));
    let html = html.replace("<!--title-->", &escaped(page.title()));
    // Last, so that nothing in it is taken for a place.
    let json = output::json_line(page)?.replace('<', "\\u003c");
    let (before, after) = html.split_once("<!--data-->").unwrap_or((&html, ""));
    Ok([before, json.trim_end(), after].concat())
}

/// A text that is no markup.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
