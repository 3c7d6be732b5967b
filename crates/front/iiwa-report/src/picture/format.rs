//! Picture files: SVG as drawn, PNG and PDF converted from it.

use std::path::Path;

use super::picture_error::PictureError;

/// File format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PictureFormat {
    /// SVG, as drawn.
    Svg,
    /// PNG with two dots per unit of the drawing, on white.
    Png,
    /// PDF page with the size of the drawing.
    Pdf,
}

impl PictureFormat {
    /// Returns the format for a file extension: `.svg`, `.png` or `.pdf`.
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

    /// Encodes a drawing in SVG as a file of this format, with a font of this system.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if the system has no font, or the drawing cannot be converted.
    pub fn encode(self, svg: String) -> Result<Vec<u8>, PictureError> {
        match self {
            Self::Svg => Ok(svg.into_bytes()),
            #[cfg(feature = "png-pdf")]
            Self::Png => super::rendered::png(&svg),
            #[cfg(feature = "png-pdf")]
            Self::Pdf => super::rendered::pdf(&svg),
            #[cfg(not(feature = "png-pdf"))]
            Self::Png | Self::Pdf => Err(PictureError::NotSupported),
        }
    }
}
