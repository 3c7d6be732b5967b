//! Common parts of pages: the arm in 3D, poses over time, style; and assembly of a page.
//!
//! A page is a single self-contained file: it contains its style, scripts and data. Its source is
//! markup with a placeholder for each part, such as `/*arm.js*/`, `<!--title-->` and `<!--data-->`.

mod arm_source;
mod poses;

pub use arm_source::ArmSource;
pub(crate) use poses::Poses;

use serde::Serialize;

use crate::PageError;

/// Placeholder in a page, and its content.
pub(crate) type PagePart = (&'static str, &'static str);

/// Parts of all pages.
const PARTS: [PagePart; 13] = [
    ("<!--head-->", include_str!("page/head.html")),
    ("/*style.css*/", include_str!("page/style.css")),
    ("/*basics.js*/", include_str!("page/basics.js")),
    ("/*poses.js*/", include_str!("page/poses.js")),
    ("/*arm.js*/", include_str!("page/arm.js")),
    ("/*surroundings.js*/", include_str!("page/surroundings.js")),
    ("/*shaders.js*/", include_str!("page/shaders.js")),
    ("/*painter.js*/", include_str!("page/painter.js")),
    ("/*shadows.js*/", include_str!("page/shadows.js")),
    ("/*look.js*/", include_str!("page/look.js")),
    ("/*sight.js*/", include_str!("page/sight.js")),
    ("/*scene.js*/", include_str!("page/scene.js")),
    ("/*view.js*/", include_str!("page/view.js")),
];

/// Assembles a page from its parts, its title and its data, which its scripts read as JSON.
pub(crate) fn assemble(
    page: &str,
    parts: &[PagePart],
    title: &str,
    data: &impl Serialize,
) -> Result<String, PageError> {
    let all = PARTS.iter().chain(parts);
    let html = all.fold(page.to_owned(), |html, (place, part)| html.replace(place, part));
    let html = html.replace("<!--title-->", &escaped(title));
    // The data come last, so that nothing in them is taken for a placeholder.
    let json = serde_json::to_string(data).map_err(|source| PageError::Json { source })?;
    let json = json.replace('<', "\\u003c");
    let (before, after) = html.split_once("<!--data-->").unwrap_or((&html, ""));
    Ok([before, &json, after].concat())
}

/// Escapes a text for HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
