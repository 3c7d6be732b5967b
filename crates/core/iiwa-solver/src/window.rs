//! The problem to solve.

use std::ops::Range;

use crate::limited_segment::LimitedSegment;

/// Segments that are solved together. A start or an end at rest is on a line.
#[derive(Clone)]
pub struct Window<'a, 'b> {
    /// All segments of a section.
    pub segments: &'a [LimitedSegment<'b>],
    /// Indices of the segments to solve for, at least one.
    pub range: Range<usize>,
    /// x (rad^2/s^2) and dx/dsigma (rad/s^2) at the start; `None` at rest.
    pub entry: Option<[f64; 2]>,
    /// x (rad^2/s^2) and dx/dsigma (rad/s^2) at the end; `None` at rest.
    pub exit: Option<[f64; 2]>,
}
