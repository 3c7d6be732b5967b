//! Splines of a program on one robot.

use std::sync::Arc;

use iiwa_kin::{
    Joints,
    rotation::{exp, log, norm, product, scaled, sub, transposed},
};

use super::{
    site::{Site, SiteResult, at_frame},
    spline::{Between, Knot, pieces},
    tcp_course::TcpCourse,
    tcp_path::TcpPath,
};
use iiwa_program::{
    CartesianFault, CartesianMotion, OrientationType, SegmentCourse, SplineSegment,
};

/// Returns the paths of the segments of a spline that starts at `from_rad`. They share one path
/// parameter.
pub(crate) fn spline<'a>(
    site: &Site<'a>,
    from_rad: &Joints,
    motion: &CartesianMotion,
    segments: &'a [SplineSegment],
) -> SiteResult<Vec<TcpPath>> {
    let types: Vec<OrientationType> =
        segments.iter().map(|segment| segment.orientation.unwrap_or(motion.orientation)).collect();
    let mut knots = vec![Knot { pose: site.pose(from_rad), e1_rad: from_rad[2] }];
    for (index, segment) in segments.iter().enumerate() {
        let frame = site.frame("frame", segment.course.target());
        let (target, pose) = frame.map_err(|fault| in_segment(index, fault))?;
        let e1_rad = target.e1_rad.unwrap_or(knots[index].e1_rad);
        knots.push(Knot { pose, e1_rad });
    }
    turn_knots(&mut knots, &types);
    let mut between = Vec::with_capacity(segments.len());
    for (index, segment) in segments.iter().enumerate() {
        let is_constant = types[index] == OrientationType::Constant;
        if is_constant {
            // A circle with an angle ends with another orientation than its frame.
            knots[index + 1].pose.rotation = knots[index].pose.rotation;
        }
        let [from, to] = [knots[index].pose, knots[index + 1].pose];
        between.push(match &segment.course {
            SegmentCourse::Spl { .. } => Between::Spl { is_constant },
            SegmentCourse::Lin { .. } => {
                let course = TcpCourse::line(&from, &to, is_constant);
                Between::Course(Box::new(
                    course.map_err(|fault| in_segment(index, at_frame(fault)))?,
                ))
            }
            SegmentCourse::Circ(circ) => {
                let course = site.circle(&from, circ, &to, is_constant);
                let course = course.map_err(|fault| in_segment(index, fault))?;
                // A circle with an angle does not end at its frame.
                knots[index + 1].pose = course.end();
                Between::Course(Box::new(course))
            }
        });
    }
    let pieces = pieces(&knots, &between);
    let pieces = pieces.map_err(|(index, fault)| in_segment(index, at_frame(fault)))?;
    let mut paths = Vec::with_capacity(pieces.len());
    let mut ranges_m = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let index = piece.segment;
        ranges_m.push(piece.range_m);
        let path = TcpPath::of(site.curve(from_rad, piece.course, piece.e1_rad));
        let path = path.map_err(|fault| in_segment(index, ("frame", fault.without_hint())))?;
        let limits = site.segment_limits(motion, &segments[index]).map(Arc::new);
        paths.push(TcpPath { stops: piece.stops, segment: index, limits, ..path });
    }
    // One path parameter for all paths, except where the TCP is at rest: there the path stops at
    // both ends.
    let moving = || paths.iter().zip(&ranges_m).filter(|(_, range_m)| **range_m > 0.0);
    let whole_rad: f64 = moving().map(|(path, _)| path.rate_rad).sum();
    let rad_a_m = whole_rad / moving().map(|(_, range_m)| range_m).sum::<f64>();
    for (path, range_m) in paths.iter_mut().zip(ranges_m) {
        if range_m > 0.0 {
            path.rate_rad = rad_a_m * range_m;
        }
    }
    Ok(paths)
}

fn in_segment(
    index: usize,
    (key, fault): (&'static str, CartesianFault),
) -> (&'static str, CartesianFault) {
    ("segments", CartesianFault::Segment { index, key, fault: Box::new(fault) })
}

/// Sets the orientation of knots that have none of their own: on a segment with constant
/// orientation that of the knot before, otherwise an orientation between those of the neighbours,
/// in proportion to chord length.
fn turn_knots(knots: &mut [Knot], types: &[OrientationType]) {
    let is_reached = |knot: usize| knot == 0 || types[knot - 1] == OrientationType::Variable;
    let mut before = 0;
    for next in (1..knots.len()).filter(|knot| is_reached(*knot)).chain([knots.len()]) {
        let from = knots[before].pose.rotation;
        let turn = knots
            .get(next)
            .map(|knot| log(&product(&transposed(&from), &knot.pose.rotation)))
            .filter(|turn| turn.iter().all(|x| x.is_finite()))
            .unwrap_or_default();
        // Distance to each knot, over segments on which the orientation may change.
        let mut way = 0.0;
        let ways: Vec<f64> = (before + 1..knots.len().min(next + 1))
            .map(|knot| {
                let [a, b] = [&knots[knot - 1].pose, &knots[knot].pose];
                if types[knot - 1] != OrientationType::Constant {
                    way += norm(&sub(&b.position_m, &a.position_m));
                }
                way
            })
            .collect();
        for (knot, knot_way) in (before + 1..next).zip(ways) {
            let share = if way > 0.0 { knot_way / way } else { 0.0 };
            knots[knot].pose.rotation = product(&from, &exp(&scaled(share, &turn)));
        }
        before = next;
    }
}
