//! Frames of a motion on one robot.

use std::{f64::consts::TAU, sync::Arc};

use iiwa_kin::{FlangePoint, Joints, Pose, Robot, Status};

use super::{
    joint_curve::{TcpCurve, WristTurn},
    quintic::Linked,
    tcp_course::{ArcTurn, ByWayOf, TcpCourse},
};
use iiwa_program::{
    AuxOrientation, CartesianFault, CartesianMotion, Circ, CourseFault, MotionLimits, Program,
    SegmentLimits, SplineSegment, Target, TargetRef,
};

/// A result, or a fault with the key of the motion that caused it.
pub(crate) type SiteResult<T> = Result<T, (&'static str, CartesianFault)>;

/// The TCP and the base of a motion.
pub(crate) struct Site<'a> {
    program: &'a Program,
    robot: &'a Arc<Robot>,
    base: Option<&'a str>,
    /// TCP in the flange frame.
    pub(crate) tcp: Pose,
}

impl<'a> Site<'a> {
    pub(crate) fn new(
        program: &'a Program,
        robot: &'a Arc<Robot>,
        motion: &'a CartesianMotion,
    ) -> SiteResult<Self> {
        let tcp = program.workcell.tcp(motion.tool.as_deref());
        let tcp = tcp.map_err(|fault| ("tool", CartesianFault::Name(fault)))?;
        Ok(Self { program, robot, base: motion.base.as_deref(), tcp })
    }

    /// Pose of the TCP in the robot base.
    pub(crate) fn pose(&self, joints_rad: &Joints) -> Pose {
        self.robot.flange_pose(joints_rad).then(&self.tcp)
    }

    /// Returns the frame under a key of the motion, and its pose in the robot base.
    pub(crate) fn frame(
        &self,
        key: &'static str,
        target: &'a TargetRef,
    ) -> SiteResult<(&'a Target, Pose)> {
        let frame = self.program.workcell.target(target, self.base);
        frame.map_err(|fault| (key, CartesianFault::Name(fault)))
    }

    /// Returns the pose in the robot base of a frame or a base under a key of the motion.
    pub(crate) fn reference(&self, key: &'static str, target: &TargetRef) -> SiteResult<Pose> {
        let pose = self.program.workcell.reference(target, self.base);
        pose.map_err(|fault| (key, CartesianFault::Name(fault)))
    }

    /// Builds a circle from one pose to another.
    pub(crate) fn circle(
        &self,
        from: &Pose,
        circ: &'a Circ,
        to: &Pose,
        is_constant: bool,
    ) -> SiteResult<TcpCourse> {
        let (_, aux) = self.frame("aux", &circ.aux)?;
        if let Some(angle) = circ.angle_rad
            // Up to one turn, with the rounding error of the conversion from degrees.
            && !(angle.abs() > 0.0 && angle.abs() <= TAU * (1.0 + 1e-12))
        {
            let found_deg = angle.to_degrees();
            return Err(("circ_angle_deg", CartesianFault::CircAngle { found_deg }));
        }
        let by_way_of = match circ.aux_orientation {
            AuxOrientation::Ignore => None,
            AuxOrientation::Consider => Some((aux.rotation, ByWayOf::Somewhere)),
            AuxOrientation::Interpolate if circ.angle_rad.is_some() => {
                return Err(("aux_orientation", CartesianFault::AuxWithAngle));
            }
            AuxOrientation::Interpolate => Some((aux.rotation, ByWayOf::AtAux)),
        };
        let turn = ArcTurn {
            with_path: circ.turns_with_path,
            by_way_of,
            extrapolates: circ.extrapolates,
            angle_rad: circ.angle_rad,
        };
        TcpCourse::arc(from, &aux.position_m, to, is_constant, &turn).map_err(at_frame)
    }

    /// Returns the limits of a segment of `spline`, or `None` if it has no limits of its own.
    pub(crate) fn segment_limits(
        &self,
        spline: &CartesianMotion,
        segment: &SplineSegment,
    ) -> Option<MotionLimits> {
        let segment_limits = &segment.limits;
        (*segment_limits != SegmentLimits::default()).then(|| {
            MotionLimits::of_segment(self.robot, spline, segment_limits, &self.program.workcell)
        })
    }

    /// Builds the TCP curve on a course, with the status of the joints at the start of the motion.
    pub(crate) fn curve(
        &self,
        start_rad: &Joints,
        course: TcpCourse,
        e1_rad: Linked<1>,
    ) -> TcpCurve {
        TcpCurve {
            robot: Arc::clone(self.robot),
            course: Arc::new(course),
            flange: self.tcp.inverse(),
            e1_rad,
            status: Status::of(self.robot, start_rad),
            wrist: None,
        }
    }
}

impl Site<'_> {
    /// Builds the linear motion of the wrist joints with which the TCP ends at the pose `to`.
    pub(crate) fn wrist_turn(
        &self,
        from_rad: &Joints,
        to: &Pose,
        e1_rad: f64,
        status: Status,
    ) -> Result<WristTurn, CartesianFault> {
        let flange = to.then(&self.tcp.inverse());
        let to_rad = self.robot.inverse(&flange, e1_rad, status)?;
        self.robot.limits().check(&to_rad).map_err(|outside| {
            CartesianFault::outside(self.robot, &flange, e1_rad, status, outside)
        })?;
        let [point, at_end] = [from_rad, &to_rad]
            .map(|joints| FlangePoint::new(self.robot, self.tcp.position_m, joints));
        // `FlangePoint` contains signs of the inverse kinematics, which the path cannot change.
        if point != at_end {
            return Err(CartesianFault::OtherSide);
        }
        let from_rad: [f64; 3] = std::array::from_fn(|k| from_rad[4 + k]);
        let by_rad = std::array::from_fn(|k| to_rad[4 + k] - from_rad[k]);
        Ok(WristTurn { point, from_rad, by_rad })
    }
}

/// Converts a fault of a course to a frame.
pub(crate) fn at_frame(fault: CourseFault) -> (&'static str, CartesianFault) {
    ("frame", CartesianFault::Course(fault))
}
