//! Errors of pictures.

/// Reason why a picture is not drawn, or not written as PNG or PDF.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The picture cannot be drawn.
    #[error("cannot draw the picture")]
    Drawing(#[source] Box<dyn std::error::Error + Send + Sync>),
    /// The text needs a font.
    #[error(
        "this system has no fonts; install some, as the package fonts-dejavu-core, or draw a .svg"
    )]
    NoFonts,
    /// The drawing exceeds the maximum size of a PNG file.
    #[error("it is too large")]
    TooLarge,
    /// This build lacks the feature `png-pdf`.
    #[error("PNG and PDF are not supported by this build (feature `png-pdf` of iiwa-report)")]
    NotSupported,
    /// The drawing cannot be converted.
    #[error("{0}")]
    Conversion(String),
}
