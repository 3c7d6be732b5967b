//! Picture files.

use std::path::Path;

use iiwa_report::PictureFormat;

use iiwa_files::Output;

use crate::{failure::Failure, features, output, output_kind::OutputKind};

/// Returns the format of a picture, by its file extension.
pub(crate) fn format(path: &Path) -> Result<PictureFormat, Failure> {
    let format = PictureFormat::of(path).ok_or_else(|| {
        Failure::input(format!("{}: pictures are written as .svg, .png or .pdf", path.display()))
    })?;
    if format != PictureFormat::Svg {
        features::PICTURES.require(&path.display().to_string())?;
    }
    Ok(format)
}

/// Starts the file of a picture, which may replace a file of the same format.
pub(crate) fn output(path: &Path) -> Result<Output, Failure> {
    output::replacing(path, OutputKind::Picture(format(path)?))
}

/// Encodes a drawing in SVG for the file `path`.
pub(crate) fn content(path: &Path, svg: String) -> Result<Vec<u8>, Failure> {
    let to_failure = |error| Failure::run(format!("cannot draw {}", path.display()), &error);
    format(path)?.encode(svg).map_err(to_failure)
}
