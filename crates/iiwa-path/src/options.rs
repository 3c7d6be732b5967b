//! How blends are made.

use crate::{continuity::Continuity, crossing::BlendSearch};

/// The curve of a blend.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BlendShape {
    /// Larsen 2019, Eq. 39 with the robot's kappa(gamma), by default that of Eq. 38: what the LBR iiwa
    /// does.
    Iiwa,
    /// Larsen 2019, Eq. 13.
    Alpha(Continuity),
    /// Larsen 2019, Eq. 26 with k = 15/2.
    MinAcceleration,
    /// Larsen 2019, Eq. 32.
    Circle,
}

/// How blends are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathOptions {
    /// Their curve.
    pub blend_shape: BlendShape,
    /// How Cartesian blends find their start and end.
    pub blend_search: BlendSearch,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self { blend_shape: BlendShape::Iiwa, blend_search: BlendSearch::FirstCrossing }
    }
}
