//! Where the frames of a motion are on one robot.

use std::{f64::consts::TAU, sync::Arc};

use iiwa_kin::{Joints, Pose, Robot, Status};

use super::{
    fault::CartesianFault,
    joint_curve::TcpCurve,
    tcp_course::{ArcTurn, ByWayOf, CourseFault, TcpCourse},
};
use crate::{
    cartesian_motion::{AuxOrientation, CartesianMotion, Circ},
    program::Program,
    target::{Target, TargetRef},
};

/// What is wrong, and the key of the motion at which it is.
pub(crate) type Found<T> = Result<T, (&'static str, CartesianFault)>;

/// The TCP and the base of a motion.
pub(crate) struct Site<'a> {
    program: &'a Program,
    robot: &'a Arc<Robot>,
    base: Option<&'a str>,
    /// The TCP in the flange's frame.
    pub(crate) tcp: Pose,
}

impl<'a> Site<'a> {
    pub(crate) fn new(
        program: &'a Program,
        robot: &'a Arc<Robot>,
        motion: &'a CartesianMotion,
    ) -> Found<Self> {
        let tcp = program.workcell.tcp(motion.tool.as_deref());
        let tcp = tcp.map_err(|fault| ("tool", CartesianFault::Name(fault)))?;
        Ok(Self { program, robot, base: motion.base.as_deref(), tcp })
    }

    /// Where the TCP is.
    pub(crate) fn pose(&self, joints_rad: &Joints) -> Pose {
        self.robot.flange_pose(joints_rad).then(&self.tcp)
    }

    /// A frame under a key of the motion, and where it is in the robot's foot.
    pub(crate) fn frame(
        &self,
        key: &'static str,
        target: &'a TargetRef,
    ) -> Found<(&'a Target, Pose)> {
        let found = self.program.workcell.target(target, self.base);
        found.map_err(|fault| (key, CartesianFault::Name(fault)))
    }

    /// A circle from one pose to another.
    pub(crate) fn circle(
        &self,
        from: &Pose,
        circ: &'a Circ,
        to: &Pose,
        is_constant: bool,
    ) -> Found<TcpCourse> {
        let (_, aux) = self.frame("aux", &circ.aux)?;
        if let Some(angle) = circ.angle_rad
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

    /// The curve of the TCP on a course, with the status of where the motion starts.
    pub(crate) fn curve(
        &self,
        start_rad: &Joints,
        course: TcpCourse,
        e1_rad: [f64; 6],
    ) -> TcpCurve {
        TcpCurve {
            robot: Arc::clone(self.robot),
            course: Arc::new(course),
            flange: self.tcp.inverse(),
            e1_rad,
            status: Status::of(self.robot, start_rad),
        }
    }
}

/// What is wrong with a course to a frame.
pub(crate) fn at_frame(fault: CourseFault) -> (&'static str, CartesianFault) {
    ("frame", CartesianFault::Course(fault))
}
