//! Segments of splines.

use std::collections::BTreeMap;

use iiwa_program::{Course, Motion, SegmentCourse};

/// Returns the segment types of each spline, as KUKA names them, by motion number from 1.
pub(crate) fn segments(motions: &[Motion]) -> BTreeMap<usize, Vec<&'static str>> {
    let name = |course: &SegmentCourse| match course {
        SegmentCourse::Spl { .. } => "SPL",
        SegmentCourse::Lin { .. } => "LIN",
        SegmentCourse::Circ(_) => "CIRC",
    };
    let types = |(index, motion): (usize, &Motion)| match motion {
        Motion::Cartesian(cartesian) => match &cartesian.course {
            Course::Spline(segments) => {
                Some((index + 1, segments.iter().map(|segment| name(&segment.course)).collect()))
            }
            _ => None,
        },
        _ => None,
    };
    motions.iter().enumerate().filter_map(types).collect()
}
