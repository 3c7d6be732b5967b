//! Motions of a program on one robot.

use std::sync::Arc;

use iiwa_kin::{
    Joints, Pose, Robot,
    rotation::{apply, product, transposed},
};

use super::{
    quintic::Linked,
    site::{Site, SiteResult, at_frame},
    spline_leg::spline,
    tcp_course::TcpCourse,
    tcp_path::TcpPath,
};
use iiwa_program::{
    CartesianFault, CartesianMotion, Course, Fault, Motion, MotionIndex, OrientationType, Program,
};

/// A motion on one robot.
#[derive(Clone, Debug)]
pub(crate) struct Leg {
    /// Joints at start and end without blends, in rad.
    pub(crate) ends_rad: [Joints; 2],
    /// The TCP path, segment by segment; empty for a straight line in joint space.
    pub(crate) paths: Vec<TcpPath>,
}

/// Builds the motion of an entry, which starts at `from_rad`; `None` for waits and loads.
pub(crate) fn leg(
    program: &Program,
    robot: &Arc<Robot>,
    from_rad: &Joints,
    motion: MotionIndex,
    entry: &Motion,
) -> Result<Option<Leg>, Fault> {
    match entry {
        Motion::Ptp(ptp) => {
            Ok(Some(Leg { ends_rad: [*from_rad, ptp.target_rad], paths: Vec::new() }))
        }
        Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => Ok(None),
        Motion::Cartesian(cartesian) => {
            to_frame(program, robot, from_rad, cartesian).map(Some).map_err(|(key, fault)| {
                Fault::Cartesian { motion: Some(motion), key, fault: Box::new(fault) }
            })
        }
    }
}

/// Builds a motion to a frame that starts at `from_rad`.
fn to_frame(
    program: &Program,
    robot: &Arc<Robot>,
    from_rad: &Joints,
    motion: &CartesianMotion,
) -> SiteResult<Leg> {
    if let Course::Ptp { to } = &motion.course {
        let names = [motion.tool.as_deref(), motion.base.as_deref()];
        let to_rad = program.joints_at(robot, Some(from_rad), to, names)?;
        return Ok(Leg { ends_rad: [*from_rad, to_rad], paths: Vec::new() });
    }
    let site = Site::new(program, robot, motion)?;
    let from = site.pose(from_rad);
    // The orientation of the TCP follows from the wrist joints, so that of the course is unused.
    let by_joints = motion.orientation == OrientationType::Joints;
    let is_constant = by_joints || motion.orientation == OrientationType::Constant;
    let (course, to, e1_rad, status) = match &motion.course {
        Course::Ptp { to } | Course::Lin { to } => {
            let (target, pose) = site.frame("frame", to)?;
            let course = TcpCourse::line(&from, &pose, is_constant).map_err(at_frame)?;
            (course, pose, target.e1_rad, target.status)
        }
        Course::LinRel { offset, e1_rad, within } => {
            let axes = match within {
                Some(within) => site.reference("in", within)?.rotation,
                None => from.rotation,
            };
            let to = moved_by(&from, &offset.pose(), &axes);
            let course = TcpCourse::line(&from, &to, is_constant);
            let course = course.map_err(|fault| ("offset", CartesianFault::Course(fault)))?;
            (course, to, *e1_rad, None)
        }
        Course::Circ(circ) => {
            let (target, pose) = site.frame("frame", &circ.to)?;
            let course = site.circle(&from, circ, &pose, is_constant)?;
            (course, pose, target.e1_rad, target.status)
        }
        Course::Spline(segments) => {
            let paths = spline(&site, from_rad, motion, segments);
            let paths = paths.map_err(|error| match error {
                // A single SPL, which is a spline without a list of segments.
                (_, CartesianFault::Segment { key, fault, .. }) if motion.is_single_spl() => {
                    (key, *fault)
                }
                error => error,
            })?;
            let to_rad = match paths.last() {
                Some(last) => last.end_rad().map_err(|fault| ("segments", fault))?,
                None => *from_rad,
            };
            return Ok(Leg { ends_rad: [*from_rad, to_rad], paths });
        }
    };
    let to_e1_rad = e1_rad.unwrap_or(from_rad[2]);
    let key = motion.end_key();
    let mut curve = site.curve(from_rad, course, Linked::even([from_rad[2]], [to_e1_rad]));
    if by_joints {
        // A circle with an angle does not end at its frame.
        let to = Pose { position_m: curve.course.end().position_m, ..to };
        let status = status.unwrap_or(curve.status);
        let turn = site.wrist_turn(from_rad, &to, to_e1_rad, status);
        curve.wrist = Some(turn.map_err(|fault| (key, fault))?);
    }
    let path = TcpPath::of(curve).map_err(|fault| (key, fault))?;
    let to_rad = path.end_rad().map_err(|fault| (key, fault))?;
    Ok(Leg { ends_rad: [*from_rad, to_rad], paths: vec![path] })
}

/// Applies an offset along `axes` to a pose.
fn moved_by(from: &Pose, offset: &Pose, axes: &[[f64; 3]; 3]) -> Pose {
    let by = apply(axes, &offset.position_m);
    let turn = product(&product(axes, &offset.rotation), &transposed(axes));
    Pose {
        position_m: std::array::from_fn(|i| from.position_m[i] + by[i]),
        rotation: product(&turn, &from.rotation),
    }
}
