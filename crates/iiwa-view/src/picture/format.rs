//! Pictures as files: SVG as it is drawn, PNG and PDF made of it.

use std::path::Path;

use svg2pdf::{
    ConversionOptions, PageOptions,
    usvg::{Options, Tree, fontdb::FaceInfo},
};

/// Dots of a PNG file a unit of the drawing: sharp on dense screens, and in print.
const SCALE: f32 = 2.0;

/// How a picture is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PictureFormat {
    /// As it is drawn.
    Svg,
    /// Two dots a unit of the drawing, on white.
    Png,
    /// A page of the drawing's size.
    Pdf,
}

/// Why a drawing is not written as PNG or PDF.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// Text needs a font.
    #[error(
        "this system has no fonts; install some, as the package fonts-dejavu-core, or draw a .svg"
    )]
    NoFonts,
    /// The drawing is larger than a PNG file may be.
    #[error("it is too large")]
    TooLarge,
    /// It cannot be converted.
    #[error("{0}")]
    Conversion(String),
}

impl PictureFormat {
    /// That of a file's ending: `.svg`, `.png` or `.pdf`.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match &*ending {
            "svg" => Some(Self::Svg),
            "png" => Some(Self::Png),
            "pdf" => Some(Self::Pdf),
            _ => None,
        }
    }

    /// The content of a file of this format for a drawing in SVG, with a font of this system.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if the system has no font, or the drawing cannot be converted.
    pub fn encode(self, svg: String) -> Result<Vec<u8>, PictureError> {
        if self == Self::Svg {
            return Ok(svg.into_bytes());
        }
        let refuse = |what: String| PictureError::Conversion(what);
        let mut options = Options::default();
        options.fontdb_mut().load_system_fonts();
        let family = sans_serif(&options).ok_or(PictureError::NoFonts)?;
        options.fontdb_mut().set_sans_serif_family(family);
        let tree = Tree::from_str(&svg, &options).map_err(|error| refuse(error.to_string()))?;
        if self == Self::Pdf {
            return svg2pdf::to_pdf(&tree, ConversionOptions::default(), PageOptions::default())
                .map_err(|error| refuse(error.to_string()));
        }
        let size = tree.size().to_int_size().scale_by(SCALE);
        let sheet =
            size.and_then(|size| resvg::tiny_skia::Pixmap::new(size.width(), size.height()));
        let mut sheet = sheet.ok_or(PictureError::TooLarge)?;
        // Drawings are for paper.
        sheet.fill(resvg::tiny_skia::Color::WHITE);
        let scale = resvg::tiny_skia::Transform::from_scale(SCALE, SCALE);
        resvg::render(&tree, scale, &mut sheet.as_mut());
        sheet.encode_png().map_err(|error| refuse(error.to_string()))
    }
}

/// A family of the system's fonts that is like what browsers take, or else any.
fn sans_serif(options: &Options<'_>) -> Option<String> {
    let name = |face: &FaceInfo| face.families.first().map(|(name, _)| name.clone());
    let families: Vec<String> = options.fontdb.faces().filter_map(name).collect();
    ["DejaVu Sans", "Liberation Sans", "Noto Sans", "Arial", "Helvetica"]
        .into_iter()
        .find(|liked| families.iter().any(|family| family == liked))
        .map(str::to_owned)
        .or_else(|| families.into_iter().next())
}
