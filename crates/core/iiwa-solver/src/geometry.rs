//! The derivatives of a segment by sigma, at some places at once.

use iiwa_path::{Coordinates, PLACES};

/// First to third derivative of q by sigma; in 1, 1/rad and 1/rad^2. The last of each, of the coordinate of the tool,
/// is in its unit instead of rad.
pub(crate) type SigmaDerivatives = [Coordinates; 3];

/// A number for each of some places.
pub(crate) type Places = [f64; PLACES];

/// First to third derivative of q by sigma at eight places of a segment, in the form in which its shape has them.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Geometry {
    /// On a line the first is the same everywhere, and the others are zero.
    Line,
    /// In a plane: the derivatives of f, of which the curve is the graph.
    Planar([[f64; PLACES]; 3]),
    /// Of each coordinate.
    General(Box<[[Coordinates; 3]; PLACES]>),
}

impl Geometry {
    /// The derivatives of f at one place.
    #[inline(always)]
    pub(crate) fn across(&self, place: usize) -> [f64; 3] {
        match self {
            Self::Planar(across) => across.map(|derivative| derivative[place]),
            Self::Line | Self::General(_) => [0.0; 3],
        }
    }
}

/// What multiplies the two directions of a plane in speed, acceleration and jerk, where sigma has these rates
/// and the derivatives of f are `across`.
#[inline(always)]
pub(crate) fn in_plane([c1, c2, c3]: [f64; 3], [v, a, j]: [f64; 3]) -> [[f64; 2]; 3] {
    [[v, c1 * v], [a, c1 * a + c2 * v * v], [j, c1 * j + 3.0 * c2 * v * a + c3 * v * v * v]]
}
