//! What is solved for.

use std::ops::Range;

use crate::limited_segment::LimitedSegment;

/// Segments that are solved for together. Where they start or end at rest, it is on a line.
#[derive(Clone)]
pub struct Window<'a, 'b> {
    /// All segments of a section.
    pub segments: &'a [LimitedSegment<'b>],
    /// Which of them, at least one.
    pub range: Range<usize>,
    /// x (rad^2/s^2) and its derivative by sigma (rad/s^2) at the start; none at rest.
    pub entry: Option<[f64; 2]>,
    /// The same at the end.
    pub exit: Option<[f64; 2]>,
}
