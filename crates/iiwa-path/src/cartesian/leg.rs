//! The motions of a program as they are on one robot.

use std::{f64::consts::TAU, sync::Arc};

use iiwa_kin::{Joints, Number, Pose, Robot, Status, Taylor};

use super::{
    fault::CartesianFault,
    joint_curve::{CurveFault, JointCurve, TcpCurve},
    rotation::{apply, product, transposed},
    tcp_course::{ArcTurn, ByWayOf, TcpCourse},
};
use crate::{
    cartesian_motion::{AuxOrientation, CartesianMotion, Circ, Course, OrientationType},
    fault::Fault,
    joint_spline::{CurveFaultAt, JointSpline},
    program::{Motion, Program, Start},
    target::{Target, TargetRef},
};

/// A motion on one robot.
#[derive(Clone, Debug)]
pub(crate) struct Leg {
    /// Where it starts and ends if nothing is blended, in rad.
    pub(crate) ends_rad: [Joints; 2],
    /// The path of the TCP; none if it is straight in joint space.
    pub(crate) path: Option<TcpPath>,
}

/// A path of the TCP, and its image.
#[derive(Clone, Debug)]
pub(crate) struct TcpPath {
    pub(crate) curve: Arc<TcpCurve>,
    pub(crate) image: Arc<JointSpline>,
    /// dsigma/ds, in rad.
    pub(crate) rate_rad: f64,
}

/// What is wrong, and the key of the motion at which it is.
type Found<T> = Result<T, (&'static str, CartesianFault)>;

/// The motions in order, each from where the one before ends; none for waits.
pub(crate) fn legs(program: &Program, robot: &Arc<Robot>) -> Result<Vec<Option<Leg>>, Fault> {
    let mut at_rad = program.start_rad(robot)?;
    let mut legs = Vec::with_capacity(program.motions.len());
    for (motion, entry) in program.entries() {
        let leg = match entry {
            Motion::Ptp(ptp) => Some(Leg { ends_rad: [at_rad, ptp.target_rad], path: None }),
            Motion::Wait { .. } => None,
            Motion::Cartesian(own) => {
                Some(leg(program, robot, &at_rad, own).map_err(|(key, fault)| {
                    Fault::Cartesian { motion: Some(motion), key, fault: Box::new(fault) }
                })?)
            }
        };
        if let Some(leg) = &leg {
            at_rad = leg.ends_rad[1];
        }
        legs.push(leg);
    }
    Ok(legs)
}

impl Program {
    /// Where the arm stands before the first motion, in rad.
    ///
    /// # Errors
    ///
    /// If the start is given as a frame that the robot cannot reach.
    pub fn start_rad(&self, robot: &Robot) -> Result<Joints, Fault> {
        match &self.start {
            Start::Joints(joints_rad) => Ok(*joints_rad),
            Start::Frame(target) => {
                joints_at(self, robot, None, target, [None, None]).map_err(|(key, fault)| {
                    Fault::Cartesian { motion: None, key, fault: Box::new(fault) }
                })
            }
        }
    }
}

/// The joints at a target, with E1 and status of `before` where it has none of its own.
fn joints_at(
    program: &Program,
    robot: &Robot,
    before: Option<&Joints>,
    target: &TargetRef,
    [tool, base]: [Option<&str>; 2],
) -> Found<Joints> {
    let named = |key| move |fault| (key, CartesianFault::Name(fault));
    let tcp = program.workcell.tcp(tool).map_err(named("tool"))?;
    let (target, pose) = program.workcell.target(target, base).map_err(named("frame"))?;
    let e1_rad = target.e1_rad.or(before.map(|q| q[2])).unwrap_or(0.0);
    let status = target
        .status
        .or(before.map(|q| Status::of(robot, q)))
        .unwrap_or_else(|| Status::of(robot, &[0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0]));
    let at_frame = |fault| ("frame", fault);
    let joints = robot
        .inverse(&pose.then(&tcp.inverse()), e1_rad, status)
        .map_err(|fault| at_frame(CartesianFault::Unreachable(fault)))?;
    robot.limits().check(&joints).map_err(|fault| at_frame(CartesianFault::Outside(fault)))?;
    Ok(joints)
}

/// A motion to a frame that starts at `from_rad`.
fn leg(
    program: &Program,
    robot: &Arc<Robot>,
    from_rad: &Joints,
    motion: &CartesianMotion,
) -> Found<Leg> {
    let CartesianMotion { tool, base, .. } = motion;
    let names = [tool.as_deref(), base.as_deref()];
    if let Course::Ptp { to } = &motion.course {
        let to_rad = joints_at(program, robot, Some(from_rad), to, names)?;
        return Ok(Leg { ends_rad: [*from_rad, to_rad], path: None });
    }
    let named = |key| move |fault| (key, CartesianFault::Name(fault));
    let tcp = program.workcell.tcp(names[0]).map_err(named("tool"))?;
    let from = robot.flange_pose(from_rad).then(&tcp);
    let frame = |key: &'static str, target| -> Found<(&Target, Pose)> {
        program.workcell.target(target, names[1]).map_err(named(key))
    };
    let is_constant = motion.orientation == OrientationType::Constant;
    let (course, e1_rad) = match &motion.course {
        Course::Ptp { to } | Course::Lin { to } => {
            let (target, pose) = frame("frame", to)?;
            (TcpCourse::line(&from, &pose, is_constant), target.e1_rad)
        }
        Course::LinRel { offset, e1_rad, within } => {
            let offset = offset.pose();
            let axes = match within {
                Some(within) => frame("in", within)?.1.rotation,
                None => from.rotation,
            };
            let by = apply(&axes, &offset.position_m);
            let turn = product(&product(&axes, &offset.rotation), &transposed(&axes));
            let to = Pose {
                position_m: std::array::from_fn(|i| from.position_m[i] + by[i]),
                rotation: product(&turn, &from.rotation),
            };
            (TcpCourse::line(&from, &to, is_constant), *e1_rad)
        }
        Course::Circ(Circ {
            aux,
            to,
            angle_rad,
            turns_with_path,
            aux_orientation,
            extrapolates,
        }) => {
            let (_, aux) = frame("aux", aux)?;
            let (target, pose) = frame("frame", to)?;
            if let Some(angle) = angle_rad
                && !(angle.abs() > 0.0 && angle.abs() <= TAU * (1.0 + 1e-12))
            {
                let found_deg = angle.to_degrees();
                return Err(("circ_angle_deg", CartesianFault::CircAngle { found_deg }));
            }
            let by_way_of = match aux_orientation {
                AuxOrientation::Ignore => None,
                AuxOrientation::Consider => Some((aux.rotation, ByWayOf::Somewhere)),
                AuxOrientation::Interpolate if angle_rad.is_some() => {
                    return Err(("aux_orientation", CartesianFault::AuxWithAngle));
                }
                AuxOrientation::Interpolate => Some((aux.rotation, ByWayOf::AtAux)),
            };
            let turn = ArcTurn {
                with_path: *turns_with_path,
                by_way_of,
                extrapolates: *extrapolates,
                angle_rad: *angle_rad,
            };
            (TcpCourse::arc(&from, &aux.position_m, &pose, is_constant, &turn), target.e1_rad)
        }
    };
    let course = course.map_err(|fault| (motion.end_key(), CartesianFault::Course(fault)))?;
    let e1_from = from_rad[2];
    let curve = TcpCurve {
        robot: Arc::clone(robot),
        course: Arc::new(course),
        flange: tcp.inverse(),
        e1_rad: [e1_from, e1_rad.unwrap_or(e1_from) - e1_from],
        status: Status::of(robot, from_rad),
    };
    let path = TcpPath::of(&curve).map_err(|fault| (motion.end_key(), fault))?;
    let end = path.curve.at(Taylor::constant(1.0)).map(|joints| joints.map(Number::value));
    let to_rad =
        end.map_err(|fault| (motion.end_key(), curve.fault(CurveFaultAt { s: 1.0, fault })))?;
    Ok(Leg { ends_rad: [*from_rad, to_rad], path: Some(path) })
}

impl TcpPath {
    fn of(curve: &TcpCurve) -> Result<Self, CartesianFault> {
        let curve = Arc::new(curve.clone());
        let image = JointSpline::of(Arc::clone(&curve) as Arc<dyn JointCurve>)
            .map_err(|found| curve.fault(found))?;
        if let Some((joint, s, found_rad)) = image.outside(curve.robot.limits()) {
            return Err(CartesianFault::OutsideOnTheWay {
                s,
                outside: curve.robot.limits().outside(joint, found_rad),
                other_e1_deg: curve.other_e1_deg(),
            });
        }
        let rate_rad = image.mean_rate_rad();
        Ok(Self { curve, image: Arc::new(image), rate_rad })
    }
}

/// Farther than this from singular poses another E1 has to keep the arm, to be worth a mention.
const CLEAR: f64 = 0.1;

impl TcpCurve {
    /// What is wrong where the curve cannot be followed.
    pub(crate) fn fault(&self, CurveFaultAt { s, fault }: CurveFaultAt) -> CartesianFault {
        match fault {
            CurveFault::Unreachable(reason) if s == 1.0 => CartesianFault::Unreachable(reason),
            CurveFault::Unreachable(reason) => CartesianFault::UnreachableOnTheWay { s, reason },
            CurveFault::Singular(part) => {
                CartesianFault::Singular { s, part: Some(part), other_e1_deg: self.other_e1_deg() }
            }
            CurveFault::Abrupt => {
                let other_e1_deg = self.other_e1_deg();
                // Far outside its range, at half a turn, a joint jumps to the other side.
                let joints = self.at(Taylor::constant(s)).map(|joints| joints.map(Number::value));
                match joints.map(|joints| self.robot.limits().check(&joints)) {
                    Ok(Err(outside)) => {
                        CartesianFault::OutsideOnTheWay { s, outside, other_e1_deg }
                    }
                    _ => CartesianFault::Singular { s, part: None, other_e1_deg },
                }
            }
        }
    }

    /// Another E1 at the target, in degrees, with which the arm can follow the curve and stays away from singular
    /// poses: the nearest in steps of five degrees.
    fn other_e1_deg(&self) -> Option<f64> {
        const STEP_DEG: f64 = 5.0;
        const SAMPLES: u32 = 32;
        let [from, by] = self.e1_rad;
        let nearest = ((from + by).to_degrees() / STEP_DEG).round();
        let tries = (1..=68).map(|k| {
            let away = f64::from((k + 1) / 2);
            STEP_DEG * if k % 2 == 0 { nearest - away } else { nearest + away }
        });
        let is_clear = |e1_deg: &f64| {
            let other = Self { e1_rad: [from, e1_deg.to_radians() - from], ..self.clone() };
            (0..=SAMPLES).all(|i| {
                let s = f64::from(i) / f64::from(SAMPLES);
                other.at(Taylor::constant(s)).is_ok_and(|joints| {
                    let joints = joints.map(Number::value);
                    let starts = i == 0;
                    (starts || self.robot.singularity(&joints).least().0 > CLEAR)
                        && self.robot.limits().check(&joints).is_ok()
                })
            })
        };
        tries.into_iter().find(is_clear)
    }
}

impl CartesianMotion {
    /// The key of a program that says where it ends.
    fn end_key(&self) -> &'static str {
        if matches!(self.course, Course::LinRel { .. }) { "offset" } else { "frame" }
    }
}

impl CurveFaultAt {
    /// What is wrong with a blend.
    pub(crate) fn in_blend(self) -> CartesianFault {
        let Self { s, fault } = self;
        match fault {
            CurveFault::Unreachable(reason) => CartesianFault::UnreachableOnTheWay { s, reason },
            CurveFault::Singular(part) => {
                CartesianFault::Singular { s, part: Some(part), other_e1_deg: None }
            }
            CurveFault::Abrupt => CartesianFault::Singular { s, part: None, other_e1_deg: None },
        }
    }
}
