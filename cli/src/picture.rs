//! Pictures as files: SVG as it is drawn, PNG and PDF made of it.

use std::{io, path::Path};

use svg2pdf::{
    ConversionOptions, PageOptions,
    usvg::{Options, Tree},
};

use crate::failure::Failure;

/// Dots of a PNG file a unit of the drawing: sharp on dense screens, and in print.
const SCALE: f32 = 2.0;

/// How a picture is written.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PictureFormat {
    Svg,
    Png,
    Pdf,
}

impl PictureFormat {
    /// That of a file's ending.
    fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match &*ending {
            "svg" => Some(Self::Svg),
            "png" => Some(Self::Png),
            "pdf" => Some(Self::Pdf),
            _ => None,
        }
    }
}

/// Refuses a file whose ending is not that of a picture.
pub(crate) fn check(path: &Path) -> Result<(), Failure> {
    match PictureFormat::of(path) {
        Some(_) => Ok(()),
        None => Err(Failure::input(format!(
            "{}: pictures are written as .svg, .png or .pdf",
            path.display()
        ))),
    }
}

/// The content of the file `path` for a drawing in SVG.
pub(crate) fn content(path: &Path, svg: String) -> Result<Vec<u8>, Failure> {
    let format = PictureFormat::of(path).unwrap_or(PictureFormat::Svg);
    if format == PictureFormat::Svg {
        return Ok(svg.into_bytes());
    }
    let refuse = |what: String| {
        Failure::run(format!("cannot draw {}", path.display()), &io::Error::other(what))
    };
    let mut options = Options::default();
    options.fontdb_mut().load_system_fonts();
    let Some(family) = sans_serif(&options) else {
        return Err(refuse(
            "this system has no fonts; install some, as the package fonts-dejavu-core, or draw a .svg".to_owned(),
        ));
    };
    options.fontdb_mut().set_sans_serif_family(family);
    let tree = Tree::from_str(&svg, &options).map_err(|error| refuse(error.to_string()))?;
    if format == PictureFormat::Pdf {
        return svg2pdf::to_pdf(&tree, ConversionOptions::default(), PageOptions::default())
            .map_err(|error| refuse(error.to_string()));
    }
    let size = tree.size().to_int_size().scale_by(SCALE);
    let sheet = size.and_then(|size| resvg::tiny_skia::Pixmap::new(size.width(), size.height()));
    let mut sheet = sheet.ok_or_else(|| refuse("it is too large".to_owned()))?;
    // Drawings are for paper.
    sheet.fill(resvg::tiny_skia::Color::WHITE);
    let scale = resvg::tiny_skia::Transform::from_scale(SCALE, SCALE);
    resvg::render(&tree, scale, &mut sheet.as_mut());
    sheet.encode_png().map_err(|error| refuse(error.to_string()))
}

/// A family of the system's fonts that is like what browsers take, or else any.
fn sans_serif(options: &Options<'_>) -> Option<String> {
    let names = |face: &svg2pdf::usvg::fontdb::FaceInfo| {
        face.families.first().map(|(name, _)| name.clone())
    };
    let families: Vec<String> = options.fontdb.faces().filter_map(names).collect();
    ["DejaVu Sans", "Liberation Sans", "Noto Sans", "Arial", "Helvetica"]
        .into_iter()
        .find(|liked| families.iter().any(|family| family == liked))
        .map(str::to_owned)
        .or_else(|| families.into_iter().next())
}
