//! Random TCP paths are planned, or rejected for a valid cause: checked against an independent
//! computation of the TCP path with nalgebra, and the joint positions along it.

use std::collections::BTreeMap;

use iiwa_kin::{Joints, Pose, Robot, Status, vector};
use iiwa_path::{JointPath, Step};
use iiwa_program::{
    AuxOrientation, CartesianFault, CartesianMotion, Course, Fault, Motion, OrientationType,
    Program, TargetRef,
};
use iiwasim_tests::tcp_programs::{cause, single_path};
use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// TCP pose as a function of s.
type TcpAt = Box<dyn Fn(f64) -> Isometry3<f64>>;

fn target(
    program: &Program,
    motion: &CartesianMotion,
    to: &TargetRef,
) -> (Isometry3<f64>, Option<f64>) {
    let (target, pose) = program.workcell.target(to, motion.base.as_deref()).unwrap();
    (pose.to_isometry(), target.e1_rad)
}

/// Returns the course of a line or circle, and E1 at its end; `None` for laws of orientation that
/// are not checked here.
fn course(
    program: &Program,
    from: Isometry3<f64>,
    motion: &CartesianMotion,
) -> Option<(TcpAt, Option<f64>)> {
    let is_constant = motion.orientation == OrientationType::Constant;
    let turn = move |to: &UnitQuaternion<f64>| {
        if is_constant { Vector3::zeros() } else { (from.rotation.inverse() * to).scaled_axis() }
    };
    match &motion.course {
        Course::Lin { to } => {
            let (to, e1) = target(program, motion, to);
            let axis = turn(&to.rotation);
            let pose_at = move |s: f64| {
                let position = from.translation.vector.lerp(&to.translation.vector, s);
                let rotation = from.rotation * UnitQuaternion::from_scaled_axis(s * axis);
                Isometry3::from_parts(Translation3::from(position), rotation)
            };
            Some((Box::new(pose_at), e1))
        }
        Course::Circ(circ) => {
            let is_plain = circ.aux_orientation == AuxOrientation::Ignore && !circ.turns_with_path;
            if !is_plain && !is_constant {
                return None;
            }
            let (aux, _) = target(program, motion, &circ.aux);
            let (to, e1) = target(program, motion, &circ.to);
            let start = from.translation.vector;
            let [a, b] = [aux, to].map(|pose| pose.translation.vector - start);
            // The centre is equidistant from all three points: two equations, and it is in their
            // plane.
            let normal = a.cross(&b).normalize();
            let rows =
                nalgebra::Matrix3::from_rows(&[a.transpose(), b.transpose(), normal.transpose()]);
            let right = Vector3::new(0.5 * a.norm_squared(), 0.5 * b.norm_squared(), 0.0);
            let radius = -rows.try_inverse()? * right;
            let centre = start - radius;
            let arm = to.translation.vector - centre;
            let programmed = normal.dot(&radius.cross(&arm)).atan2(radius.dot(&arm));
            let programmed = programmed.rem_euclid(std::f64::consts::TAU);
            let angle = circ.angle_rad.unwrap_or(programmed);
            let stretch = if circ.extrapolates { angle / programmed } else { 1.0 };
            let axis = stretch * turn(&to.rotation);
            let pose_at = move |s: f64| {
                let arm = Rotation3::from_scaled_axis(s * angle * normal) * radius;
                let rotation = from.rotation * UnitQuaternion::from_scaled_axis(s * axis);
                Isometry3::from_parts(Translation3::from(centre + arm), rotation)
            };
            Some((Box::new(pose_at), e1))
        }
        _ => None,
    }
}

/// Joint positions along a course.
struct Along<'a> {
    robot: &'a Robot,
    course: TcpAt,
    flange: Isometry3<f64>,
    e1_rad: [f64; 2],
    status: Status,
}

impl Along<'_> {
    /// Returns the joint positions at s; `None` if out of reach.
    fn joints(&self, s: f64) -> Option<Joints> {
        let flange = (self.course)(s) * self.flange;
        let rotation = flange.rotation.to_rotation_matrix();
        let pose = Pose {
            position_m: flange.translation.vector.into(),
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| rotation[(i, j)])),
        };
        let e1 = self.e1_rad[0] + s * (self.e1_rad[1] - self.e1_rad[0]);
        self.robot.inverse(&pose, e1, self.status).ok()
    }

    /// Returns the distance to a singularity near `s`, for causes that refer to some `s`.
    fn singularity(&self, s: f64) -> f64 {
        let joints = self.joints(s.clamp(0.0, 1.0));
        joints.map_or(0.0, |joints| self.robot.singularity(&joints).nearest().0)
    }
}

/// Number of samples along a path.
const SAMPLES: u32 = 400;

/// Checks the planner's result for a path; returns the cause if the path is rejected.
fn judge(robot: &Robot, program: &Program) -> Result<&'static str, String> {
    let Motion::Cartesian(motion) = &program.motions[0] else { return Ok("not checked") };
    let start_rad = *program.start.joints_rad().unwrap();
    let tcp = program.workcell.tcp(motion.tool.as_deref()).unwrap().to_isometry();
    let from = robot.flange_pose(&start_rad).to_isometry() * tcp;
    let planned = JointPath::new(program, robot);
    let Some((course, e1)) = course(program, from, motion) else {
        return Ok("not checked");
    };
    let along = Along {
        robot,
        course,
        flange: tcp.inverse(),
        e1_rad: [start_rad[2], e1.unwrap_or(start_rad[2])],
        status: Status::of(robot, &start_rad),
    };
    let samples = (0..=SAMPLES).map(|i| f64::from(i) / f64::from(SAMPLES));
    let limits = robot.limits();
    match planned {
        Ok(path) => {
            let segment = path.steps().iter().find_map(|step| match step {
                Step::Move { segment, .. } => Some(segment),
                _ => None,
            });
            let Some(segment) = segment else { return Ok("no motion") };
            for s in samples {
                let Some(expected) = along.joints(s) else {
                    return Err(format!("planned, but out of reach at {s}"));
                };
                if let Err(outside) = limits.check(&expected) {
                    return Err(format!("planned, but at {s} {outside}"));
                }
                let off = vector::distance(&segment.at(s).q, &expected);
                // Near singularities, rounding of the pose is amplified in the joint positions.
                if off > 1e-8 + 1e-12 / along.singularity(s) {
                    return Err(format!("off the course by {off:e} rad at {s}"));
                }
            }
            Ok("planned")
        }
        Err(fault) => {
            let cause = cause(&fault);
            let Fault::Cartesian { fault, .. } = fault else { return Err(fault.to_string()) };
            let holds = match &*fault {
                CartesianFault::Unreachable(_) => along.joints(1.0).is_none(),
                CartesianFault::UnreachableOnTheWay { s, .. } => along.joints(*s).is_none(),
                CartesianFault::OutsideOnTheWay { s, .. } => {
                    along.joints(*s).is_some_and(|joints| limits.check(&joints).is_err())
                }
                CartesianFault::Singular { s, part, .. } => {
                    // An abrupt change is localised only approximately.
                    let (tolerance, reach) =
                        if part.is_some() { (1e-4, 0.0) } else { (0.02, 2e-3) };
                    (-20..=20).any(|i| {
                        along.singularity(s + reach * f64::from(i) / 20.0) <= tolerance * 1.001
                    })
                }
                CartesianFault::Course(_) => true,
                _ => false,
            };
            if holds { Ok(cause) } else { Err(format!("refused, but it is not so: {fault}")) }
        }
    }
}

#[test]
fn paths_are_planned_or_refused_for_a_cause() {
    let count = if std::env::var_os("IIWASIM_LONG").is_some() { 10_000 } else { 1_000 };
    let (mut counts, mut wrong) = (BTreeMap::<_, usize>::new(), 0);
    for is_circ in [false, true] {
        for index in 0..count {
            let (robot, program) = single_path(1, index, is_circ);
            match judge(&robot, &program) {
                Ok(cause) => *counts.entry((is_circ, cause)).or_default() += 1,
                Err(fault) => {
                    wrong += 1;
                    println!("circ {is_circ}, {index}: {fault}\n{}", program.to_json());
                }
            }
        }
    }
    println!("(is a circle, what) {counts:#?}");
    assert_eq!(wrong, 0);
    assert!(counts[&(false, "planned")] > 300, "{counts:?}");
    assert!(counts[&(true, "planned")] > 100, "{counts:?}");
}
