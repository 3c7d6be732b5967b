//! Derivatives of a segment with respect to sigma, at several places at once.

use iiwa_path::{Coordinates, PLACES};

/// First to third derivative of q with respect to sigma; in 1, 1/rad and 1/rad^2. The last entry of
/// each, of the tool coordinate, has the unit of that coordinate instead of rad.
pub(crate) type SigmaDerivatives = [Coordinates; 3];

/// A number for each place.
pub(crate) type PlaceValues = [f64; PLACES];

/// First to third derivative of q with respect to sigma at eight places of a segment, in the form
/// that suits its shape.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Geometry {
    /// Line: the first derivative is constant, the others are zero.
    Line,
    /// Graph of a function f in a plane: the derivatives of f.
    Planar([[f64; PLACES]; 3]),
    /// General curve: the derivatives of each coordinate.
    General(Box<[[Coordinates; 3]; PLACES]>),
}

impl Geometry {
    /// Derivatives of f at one place.
    #[inline(always)]
    pub(crate) fn across(&self, place: usize) -> [f64; 3] {
        match self {
            Self::Planar(across) => across.map(|derivative| derivative[place]),
            Self::Line | Self::General(_) => [0.0; 3],
        }
    }
}

/// Coefficients of the two directions of a plane in velocity, acceleration and jerk, for these
/// rates of sigma and these derivatives of f.
#[inline(always)]
pub(crate) fn in_plane([c1, c2, c3]: [f64; 3], [v, a, j]: [f64; 3]) -> [[f64; 2]; 3] {
    [[v, c1 * v], [a, c1 * a + c2 * v * v], [j, c1 * j + 3.0 * c2 * v * a + c3 * v * v * v]]
}
