//! Blends that would exceed half of a neighbouring motion.

use crate::step::ShortenedBlend;
use iiwa_program::MotionIndex;

/// Difference from the radius in the program from which a blend counts as shortened, in mm: radii
/// are printed to a tenth.
const MIN_DIFFERENCE_MM: f64 = 0.05;

/// A blend radius that is smaller than the program asks for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShortenedRadius {
    /// Motion of which the blend takes half: 0 for the one before, 1 for the one after the target.
    side: usize,
    asked_mm: f64,
    used_mm: f64,
}

impl ShortenedRadius {
    /// Returns the radius of a blend that takes half of the motion on a `side`; `None` if the blend
    /// is as large as the program asks for.
    pub(crate) fn new(side: usize, asked_mm: f64, used_mm: f64) -> Option<Self> {
        (asked_mm - used_mm >= MIN_DIFFERENCE_MM).then_some(Self { side, asked_mm, used_mm })
    }

    /// Returns the smaller of two radii.
    pub(crate) fn smaller(self, other: Self) -> Self {
        if other.used_mm < self.used_mm { other } else { self }
    }

    /// Returns the blend between two motions.
    pub(crate) fn between(self, motions: [MotionIndex; 2]) -> ShortenedBlend {
        let Self { side, asked_mm, used_mm } = self;
        ShortenedBlend { half_of: motions[side], asked_mm, used_mm }
    }
}
