//! PNG and PDF, converted from a drawing in SVG (feature `png-pdf`).

use svg2pdf::{
    ConversionOptions, PageOptions,
    usvg::{Options, Tree, fontdb::FaceInfo},
};

use super::picture_error::PictureError;

/// Dots of a PNG file per unit of the drawing: sharp on high-resolution screens, and in print.
const SCALE: f32 = 2.0;

/// Converts to a PDF page with the size of the drawing.
pub(super) fn pdf(svg: &str) -> Result<Vec<u8>, PictureError> {
    svg2pdf::to_pdf(&tree(svg)?, ConversionOptions::default(), PageOptions::default())
        .map_err(|error| PictureError::Conversion(error.to_string()))
}

/// Converts to a PNG file on white, since drawings are designed for paper.
pub(super) fn png(svg: &str) -> Result<Vec<u8>, PictureError> {
    let tree = tree(svg)?;
    let size = tree.size().to_int_size().scale_by(SCALE);
    let sheet = size.and_then(|size| resvg::tiny_skia::Pixmap::new(size.width(), size.height()));
    let mut sheet = sheet.ok_or(PictureError::TooLarge)?;
    sheet.fill(resvg::tiny_skia::Color::WHITE);
    let scale = resvg::tiny_skia::Transform::from_scale(SCALE, SCALE);
    resvg::render(&tree, scale, &mut sheet.as_mut());
    sheet.encode_png().map_err(|error| PictureError::Conversion(error.to_string()))
}

fn tree(svg: &str) -> Result<Tree, PictureError> {
    let mut options = Options::default();
    options.fontdb_mut().load_system_fonts();
    let family = sans_serif(&options).ok_or(PictureError::NoFonts)?;
    options.fontdb_mut().set_sans_serif_family(family);
    Tree::from_str(svg, &options).map_err(|error| PictureError::Conversion(error.to_string()))
}

/// Returns an installed font family similar to that of browsers, or else any.
fn sans_serif(options: &Options<'_>) -> Option<String> {
    let name = |face: &FaceInfo| face.families.first().map(|(name, _)| name.clone());
    let families: Vec<String> = options.fontdb.faces().filter_map(name).collect();
    ["DejaVu Sans", "Liberation Sans", "Noto Sans", "Arial", "Helvetica"]
        .into_iter()
        .find(|liked| families.iter().any(|family| family == liked))
        .map(str::to_owned)
        .or_else(|| families.into_iter().next())
}
