//! Pictures as files: SVG as it is drawn, PNG and PDF made of it.

use std::path::Path;

use super::picture_error::PictureError;

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
