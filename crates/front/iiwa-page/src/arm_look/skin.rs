//! Surfaces and their colours.

use serde::Serialize;

use super::surface::Surface;

/// Colour: red, green and blue as on screens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct SurfaceColour(pub(crate) [u8; 3]);

impl SurfaceColour {
    /// Creates a colour from components between 0 and 1.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it saturates")]
    pub(super) fn of(rgb: [f64; 3]) -> Self {
        Self(rgb.map(|share| (255.0 * share).round() as u8))
    }
}

/// Surface of one colour.
#[derive(Clone, Debug)]
pub(crate) struct Skin {
    pub(super) paint: SurfaceColour,
    pub(super) surface: Surface,
}
