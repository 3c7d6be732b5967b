//! Curves in joint space that are not polynomials.

use std::{fmt, sync::Arc};

use iiwa_kin::{
    FlangePoint, MovingPose, Number, Pose, Robot, SingularPart, Status, Taylor, Unreachable,
    rotation::{Vec3, exp, log, product, transposed},
};

use super::{
    quintic::Linked,
    tcp_course::{TcpCourse, polynomial, tool_way},
};
use crate::{
    continuity::Continuity,
    line::Line,
    segment::{Segment, ToolWay},
};

/// All joints, as power series in the parameter of the curve.
pub(crate) type MovingJoints = [Taylor; 7];

/// A reason why the robot cannot follow a curve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CurveFault {
    /// The pose is out of reach.
    Unreachable(Unreachable),
    /// The pose is too near to a singularity.
    Singular(SingularPart),
    /// The joints turn too abruptly.
    Abrupt,
}

/// A curve in joint space, for s from 0 to 1.
pub(crate) trait JointCurve: fmt::Debug + Send + Sync {
    /// Joints at the parameter `s`, itself a power series.
    fn at(&self, s: Taylor) -> Result<MovingJoints, CurveFault>;

    /// Motion of the TCP, for TCP limits.
    fn tool_motion(&self, s: f64) -> ToolMotion<'_>;

    /// True if the [motion of the TCP](Self::tool_motion) is constant.
    fn is_even(&self) -> bool;
}

/// Motion of the TCP along a curve.
pub(crate) enum ToolMotion<'a> {
    /// Path length and angle, known without the joints.
    Known(ToolWay),
    /// The motion of a point in the flange frame, in m; it follows from the joints.
    OfJoints(&'a Robot, Vec3<f64>),
}

/// A TCP path.
#[derive(Clone, Debug)]
pub(crate) struct TcpCurve {
    pub(crate) robot: Arc<Robot>,
    pub(crate) course: Arc<TcpCourse>,
    /// The flange in the TCP frame.
    pub(crate) flange: Pose,
    /// Position of A3 by the share of the arc length, in rad.
    pub(crate) e1_rad: Linked<1>,
    pub(crate) status: Status,
    /// Linear motion of the wrist joints, if any, which replaces the orientation of the course.
    pub(crate) wrist: Option<WristTurn>,
}

/// Motion with A5 to A7 linear in s, in which the other joints keep the TCP on its course. A6 may
/// pass through 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WristTurn {
    /// The TCP relative to the flange.
    pub(crate) point: FlangePoint,
    /// A5 to A7 at the start, and their changes; in rad.
    pub(crate) from_rad: [f64; 3],
    pub(crate) by_rad: [f64; 3],
}

/// Measure of the distance from a singular pose below which the joints are not a function of the
/// TCP pose: 0.006 deg.
pub(crate) const SINGULAR: f64 = 1e-4;

impl TcpCurve {
    fn e1(&self, s: Taylor) -> Taylor {
        let [e1] = self.e1_rad.at(self.course.arc_share(s));
        e1
    }
}

/// Returns the joints of a moving TCP.
fn joints_of(
    robot: &Robot,
    tcp: &MovingPose,
    flange: &Pose,
    e1: Taylor,
    status: Status,
) -> Result<MovingJoints, CurveFault> {
    let joints = robot
        .inverse_moving(&tcp.then_fixed(flange), e1, status)
        .map_err(CurveFault::Unreachable)?;
    let (distance, axis) = robot.singularity(&joints.map(Number::value)).nearest();
    if distance < SINGULAR || !joints.iter().flat_map(|joint| joint.0).all(f64::is_finite) {
        return Err(CurveFault::Singular(axis));
    }
    Ok(joints)
}

impl JointCurve for TcpCurve {
    fn at(&self, s: Taylor) -> Result<MovingJoints, CurveFault> {
        let tcp = self.course.at(s);
        let Some(WristTurn { point, from_rad, by_rad }) = &self.wrist else {
            return joints_of(&self.robot, &tcp, &self.flange, self.e1(s), self.status);
        };
        let wrist = std::array::from_fn(|k| s * by_rad[k] + Taylor::constant(from_rad[k]));
        let joints = point
            .joints_at(&self.robot, &tcp.position_m, self.e1(s), wrist)
            .map_err(CurveFault::Unreachable)?;
        if !joints.iter().flat_map(|joint| joint.0).all(f64::is_finite) {
            return Err(CurveFault::Abrupt);
        }
        Ok(joints)
    }

    fn tool_motion(&self, s: f64) -> ToolMotion<'_> {
        if self.wrist.is_some() {
            return ToolMotion::OfJoints(&self.robot, self.flange.inverse().position_m);
        }
        ToolMotion::Known(match self.course.even_rates() {
            Some([way, turn]) => ToolWay { way_m: [way, 0.0, 0.0], turn_rad: [turn, 0.0, 0.0] },
            None => tool_way(&self.course.at(Taylor::variable(s))),
        })
    }

    fn is_even(&self) -> bool {
        self.wrist.is_none() && self.course.even_rates().is_some()
    }
}

/// Straight line in joint space.
impl JointCurve for Line {
    fn at(&self, s: Taylor) -> Result<MovingJoints, CurveFault> {
        let from = <Self as Segment>::at(self, 0.0).q;
        let direction = self.direction_rad();
        Ok(std::array::from_fn(|j| Taylor::constant(from[j]) + s * direction[j]))
    }

    fn tool_motion(&self, _: f64) -> ToolMotion<'_> {
        ToolMotion::Known(ToolWay::default())
    }

    fn is_even(&self) -> bool {
        true
    }
}

/// Part of a curve between two parameters.
#[derive(Clone, Debug)]
pub(crate) struct CurveInterval<C: ?Sized> {
    pub(crate) range: [f64; 2],
    pub(crate) curve: Arc<C>,
}

impl<C: ?Sized> CurveInterval<C> {
    fn inner(&self, s: Taylor) -> Taylor {
        let [from, to] = self.range;
        Taylor::constant(from) + s * (to - from)
    }
}

impl<C: JointCurve + ?Sized> JointCurve for CurveInterval<C> {
    fn at(&self, s: Taylor) -> Result<MovingJoints, CurveFault> {
        self.curve.at(self.inner(s))
    }

    fn tool_motion(&self, s: f64) -> ToolMotion<'_> {
        let [from, to] = self.range;
        let scale = to - from;
        let ToolWay { way_m, turn_rad } = match self.curve.tool_motion(from + s * scale) {
            ToolMotion::Known(way) => way,
            of_joints @ ToolMotion::OfJoints(..) => return of_joints,
        };
        let powers = [scale, scale * scale, scale * scale * scale];
        let stretched = |rates: [f64; 3]| std::array::from_fn(|k| rates[k] * powers[k]);
        ToolMotion::Known(ToolWay { way_m: stretched(way_m), turn_rad: stretched(turn_rad) })
    }

    fn is_even(&self) -> bool {
        self.curve.is_even()
    }
}

/// alpha and `kappa beta` of a blend at `s` (Larsen 2019, Eq. 18 and 21).
fn mixing(kappa: f64, s: Taylor) -> [Taylor; 2] {
    let continuity = Continuity::Second;
    [polynomial(continuity.alpha(), s), polynomial(continuity.beta(), s) * kappa]
}

/// A blend in joint space between two adjacent curves:
/// `(1 - alpha) A + alpha B - kappa beta (B'(0) - A'(1))`, which is Larsen 2019, Eq. 39 if both are
/// lines.
#[derive(Debug)]
pub(crate) struct JointBlend {
    pub(crate) robot: Arc<Robot>,
    /// Position of the TCP in the flange frame, in m.
    pub(crate) tcp_m: Vec3<f64>,
    /// The last part of one curve, and the first part of the other.
    pub(crate) parts: [CurveInterval<dyn JointCurve>; 2],
    pub(crate) kappa: f64,
    /// B'(0) - A'(1), in rad.
    pub(crate) derivative_change: [f64; 7],
}

impl JointCurve for JointBlend {
    fn at(&self, s: Taylor) -> Result<MovingJoints, CurveFault> {
        let [a, b] = [self.parts[0].at(s)?, self.parts[1].at(s)?];
        let [alpha, bulge] = mixing(self.kappa, s);
        Ok(std::array::from_fn(|j| {
            a[j] + alpha * (b[j] - a[j]) - bulge * self.derivative_change[j]
        }))
    }

    fn tool_motion(&self, _: f64) -> ToolMotion<'_> {
        ToolMotion::OfJoints(&self.robot, self.tcp_m)
    }

    fn is_even(&self) -> bool {
        false
    }
}

/// A Cartesian blend between two TCP paths: positions as in joint space, orientations by the
/// rotation from one to the other, E1 in proportion.
#[derive(Debug)]
pub(crate) struct TcpBlend {
    pub(crate) parts: [CurveInterval<TcpCurve>; 2],
    pub(crate) kappa: f64,
    /// B'(0) - A'(1), in m.
    pub(crate) derivative_change: Vec3<f64>,
}

impl TcpBlend {
    fn pose(&self, s: Taylor) -> (MovingPose, Taylor) {
        let [(a, e1_a), (b, e1_b)] = self.parts.each_ref().map(|part| {
            let s = part.inner(s);
            (part.curve.course.at(s), part.curve.e1(s))
        });
        let [alpha, bulge] = mixing(self.kappa, s);
        let position_m = std::array::from_fn(|i| {
            let (a, b) = (a.position_m[i], b.position_m[i]);
            a + alpha * (b - a) - bulge * self.derivative_change[i]
        });
        let between = log(&product(&transposed(&a.rotation), &b.rotation));
        let rotation = product(&a.rotation, &exp(&between.map(|v| alpha * v)));
        (MovingPose { position_m, rotation }, e1_a + alpha * (e1_b - e1_a))
    }
}

impl JointCurve for TcpBlend {
    fn at(&self, s: Taylor) -> Result<MovingJoints, CurveFault> {
        // One TCP (see `joins_in_space`), and the status does not change along TCP paths.
        let TcpCurve { robot, flange, status, .. } = &*self.parts[0].curve;
        let (tcp, e1) = self.pose(s);
        joints_of(robot, &tcp, flange, e1, *status)
    }

    fn tool_motion(&self, _: f64) -> ToolMotion<'_> {
        let TcpCurve { robot, flange, .. } = &*self.parts[0].curve;
        ToolMotion::OfJoints(robot, flange.inverse().position_m)
    }

    fn is_even(&self) -> bool {
        false
    }
}
