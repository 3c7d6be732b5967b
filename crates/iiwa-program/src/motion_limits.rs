//! The limits of one motion.

use enum_map::enum_map;
use iiwa_kin::{Joints, Robot};

use crate::{
    cartesian_motion::CartesianMotion,
    limit_kind::{ByKind, LimitKind},
    program::Motion,
    segment_limits::SegmentLimits,
    tool_limits::ToolLimits,
    workcell::{OperatingMode, T1_SPEED_M_S},
};

/// A motion's limits of its joints, of each kind: the robot's, times the motion's shares (Larsen 2019,
/// Eq. 33, and 35 for the share of speed); and those of the TCP.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_program::{LimitKind, MotionLimits};
///
/// let limits = MotionLimits::full(&Robot::default());
/// assert_eq!(limits.of(LimitKind::Jerk), limits.jerk_rad_s3());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionLimits {
    joints: ByKind<Joints>,
    tool: ToolLimits,
}

impl MotionLimits {
    /// All that `robot` can do.
    #[must_use]
    pub fn full(robot: &Robot) -> Self {
        let limits = robot.limits();
        let joints = enum_map! {
            LimitKind::Velocity => limits.velocity_rad_s,
            LimitKind::Acceleration => limits.acceleration_rad_s2,
            LimitKind::Jerk => limits.jerk_rad_s3,
        };
        Self { joints, tool: ToolLimits::NONE }
    }

    /// Those of `motion` on `robot`.
    #[must_use]
    pub fn of_motion(robot: &Robot, motion: &Motion, mode: OperatingMode) -> Self {
        match motion {
            Motion::Ptp(ptp) => {
                Self::of_shares(robot, |kind| ptp.share(kind), ToolLimits::NONE, mode)
            }
            Motion::Cartesian(own) => {
                Self::of_shares(robot, |kind| &own.shares[kind], own.tool_limits, mode)
            }
            Motion::Wait { .. } | Motion::Load(_) => {
                Self::of_shares(robot, |_| &[1.0; 7], ToolLimits::NONE, mode)
            }
        }
    }

    /// Those of a segment of `spline` on `robot`: its own, and the spline's where it has none.
    #[must_use]
    pub fn of_segment(
        robot: &Robot,
        spline: &CartesianMotion,
        own: &SegmentLimits,
        mode: OperatingMode,
    ) -> Self {
        let shares = |kind| own.shares[kind].as_ref().unwrap_or(&spline.shares[kind]);
        Self::of_shares(robot, shares, own.tool.or(&spline.tool_limits), mode)
    }

    fn of_shares<'a>(
        robot: &Robot,
        shares: impl Fn(LimitKind) -> &'a Joints,
        tool: ToolLimits,
        mode: OperatingMode,
    ) -> Self {
        let mut limits = Self { tool, ..Self::full(robot) };
        for (kind, limits) in &mut limits.joints {
            for (limit, share) in limits.iter_mut().zip(shares(kind)) {
                *limit *= share;
            }
        }
        if mode == OperatingMode::T1 {
            let speed = &mut limits.tool.way[LimitKind::Velocity];
            *speed = speed.min(T1_SPEED_M_S);
        }
        limits
    }

    /// Limits of `joints`, in rad/s, rad/s^2 and rad/s^3, and of the TCP; infinite where there are none.
    #[must_use]
    pub fn of_joints(joints: ByKind<Joints>, tool: ToolLimits) -> Self {
        Self { joints, tool }
    }

    /// The same, with these limits of the TCP.
    #[must_use]
    pub fn with_tool(self, tool: ToolLimits) -> Self {
        Self { tool, ..self }
    }

    /// Those of the TCP.
    #[must_use]
    pub fn tool(&self) -> &ToolLimits {
        &self.tool
    }

    /// Those of the joints of a kind; in rad/s, rad/s^2 or rad/s^3, by the kind's [order](LimitKind::order).
    #[must_use]
    pub fn of(&self, kind: LimitKind) -> &Joints {
        &self.joints[kind]
    }

    /// Those of the joints' velocity, in rad/s.
    #[must_use]
    pub fn velocity_rad_s(&self) -> &Joints {
        self.of(LimitKind::Velocity)
    }

    /// Those of the joints' acceleration, in rad/s^2.
    #[must_use]
    pub fn acceleration_rad_s2(&self) -> &Joints {
        self.of(LimitKind::Acceleration)
    }

    /// Those of the joints' jerk, in rad/s^3.
    #[must_use]
    pub fn jerk_rad_s3(&self) -> &Joints {
        self.of(LimitKind::Jerk)
    }
}
