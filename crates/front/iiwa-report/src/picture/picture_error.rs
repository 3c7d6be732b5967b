//! Errors of PNG and PDF pictures.

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
    /// This build lacks the feature `png-pdf`.
    #[error("PNG and PDF are not supported by this build (feature `png-pdf` of iiwa-report)")]
    NotSupported,
    /// It cannot be converted.
    #[error("{0}")]
    Conversion(String),
}
