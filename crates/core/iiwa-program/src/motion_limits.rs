//! Limits of one motion.

use enum_map::enum_map;
use iiwa_kin::{Joints, Robot};

use crate::{
    cartesian_motion::{CartesianMotion, SegmentLimits},
    limit_kind::{ByKind, LimitKind},
    program::Motion,
    tool_limits::ToolLimits,
    workcell::{OperatingMode, Workcell},
};

/// Joint limits of a motion, of each kind: the robot's limits times the motion's shares (Larsen
/// 2019, Eq. 33, and 35 for the share of speed); with the TCP limits.
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
    tcp_speed_source: TcpSpeedSource,
    supervised: Option<Supervised>,
}

/// Source of the limit of the TCP speed along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TcpSpeedSource {
    /// Limit of the program, or no limit.
    #[default]
    Program,
    /// Speed at which the motion has its minimum duration.
    MinimumDuration,
    /// Operating mode T1, whose limit is below that of the program.
    T1,
}

/// Effect of the operating mode T1.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Supervised {
    speed_m_s: f64,
    /// TCP speed limit in other modes.
    program_m_s: f64,
}

impl MotionLimits {
    /// Full limits of `robot`.
    #[must_use]
    pub fn full(robot: &Robot) -> Self {
        let limits = robot.limits();
        let joints = enum_map! {
            LimitKind::Velocity => limits.velocity_rad_s,
            LimitKind::Acceleration => limits.acceleration_rad_s2,
            LimitKind::Jerk => limits.jerk_rad_s3,
        };
        Self::of_joints(joints, ToolLimits::NONE)
    }

    /// Limits of `motion` on `robot`.
    #[must_use]
    pub fn of_motion(robot: &Robot, motion: &Motion, workcell: &Workcell) -> Self {
        match motion {
            Motion::Ptp(ptp) => {
                Self::of_shares(robot, |kind| ptp.share(kind), ToolLimits::NONE, workcell)
            }
            Motion::Cartesian(cartesian) => Self::of_shares(
                robot,
                |kind| &cartesian.shares[kind],
                cartesian.tool_limits,
                workcell,
            ),
            Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => {
                Self::of_shares(robot, |_| &[1.0; 7], ToolLimits::NONE, workcell)
            }
        }
    }

    /// Limits of a segment of `spline` on `robot`: the segment's limits, by default those of the
    /// spline.
    #[must_use]
    pub fn of_segment(
        robot: &Robot,
        spline: &CartesianMotion,
        segment: &SegmentLimits,
        workcell: &Workcell,
    ) -> Self {
        let shares = |kind| segment.shares[kind].as_ref().unwrap_or(&spline.shares[kind]);
        Self::of_shares(robot, shares, segment.tool.or(&spline.tool_limits), workcell)
    }

    fn of_shares<'a>(
        robot: &Robot,
        shares: impl Fn(LimitKind) -> &'a Joints,
        tool: ToolLimits,
        workcell: &Workcell,
    ) -> Self {
        let mut limits = Self { tool, ..Self::full(robot) };
        for (kind, limits) in &mut limits.joints {
            for (limit, share) in limits.iter_mut().zip(shares(kind)) {
                *limit *= share;
            }
        }
        if let Some(share) = workcell.speed_override {
            limits = limits.slowed_down(share);
        }
        if workcell.mode == OperatingMode::T1 {
            let speed = &mut limits.tool.way[LimitKind::Velocity];
            let (program_m_s, speed_m_s) = (*speed, robot.t1_speed_m_s());
            *speed = program_m_s.min(speed_m_s);
            if speed_m_s < program_m_s {
                limits.tcp_speed_source = TcpSpeedSource::T1;
            }
            limits.supervised = Some(Supervised { speed_m_s, program_m_s });
        }
        limits
    }

    /// Limits at an override of `share`: the duration of a motion is divided by `share`.
    #[must_use]
    pub fn slowed_down(mut self, share: f64) -> Self {
        for (kind, limits) in &mut self.joints {
            let slower = share.powi(kind.order().into());
            *limits = limits.map(|limit| slower * limit);
            self.tool.way[kind] *= slower;
            self.tool.turn[kind] *= slower;
        }
        self
    }

    /// Ratio of these joint jerk limits to those of `full`.
    #[must_use]
    pub fn jerk_shares(&self, full: &Self) -> Joints {
        std::array::from_fn(|j| self.jerk_rad_s3()[j] / full.jerk_rad_s3()[j])
    }

    /// Speed to which operating mode T1 limits TCP and flange, in m/s; `None` in other modes.
    #[must_use]
    pub fn supervised_m_s(&self) -> Option<f64> {
        self.supervised.map(|supervised| supervised.speed_m_s)
    }

    /// Limits in operating modes other than T1.
    #[must_use]
    pub fn unsupervised(&self) -> Self {
        let mut limits = Self { supervised: None, ..*self };
        if let Some(Supervised { program_m_s, .. }) = self.supervised {
            limits.tool.way[LimitKind::Velocity] = program_m_s;
            limits.tcp_speed_source = TcpSpeedSource::Program;
        }
        limits
    }

    /// Limits from `joints`, in rad/s, rad/s^2 and rad/s^3, and TCP limits; infinite for no limit.
    #[must_use]
    pub fn of_joints(joints: ByKind<Joints>, tool: ToolLimits) -> Self {
        Self { joints, tool, tcp_speed_source: TcpSpeedSource::Program, supervised: None }
    }

    /// Limits the TCP speed to `speed_m_s`, at which the motion has its minimum duration, unless
    /// its limit is lower already. Of equal limits, the minimum duration counts as the source: the
    /// program cannot raise it.
    #[must_use]
    pub fn with_minimum_duration(mut self, speed_m_s: f64) -> Self {
        const ROUNDING: f64 = 1e-9;
        let speed = &mut self.tool.way[LimitKind::Velocity];
        if speed_m_s <= *speed * (1.0 + ROUNDING) {
            *speed = speed.min(speed_m_s);
            self.tcp_speed_source = TcpSpeedSource::MinimumDuration;
        }
        self
    }

    /// Source of the limit of the TCP speed along the path.
    #[must_use]
    pub fn tcp_speed_source(&self) -> TcpSpeedSource {
        self.tcp_speed_source
    }

    /// Replaces the TCP limits.
    #[must_use]
    pub fn with_tool(self, tool: ToolLimits) -> Self {
        Self { tool, ..self }
    }

    /// TCP limits.
    #[must_use]
    pub fn tool(&self) -> &ToolLimits {
        &self.tool
    }

    /// Joint limits of a kind, in rad/s, rad/s^2 or rad/s^3 by the kind's
    /// [order](LimitKind::order).
    #[must_use]
    pub fn of(&self, kind: LimitKind) -> &Joints {
        &self.joints[kind]
    }

    /// Joint velocity limits, in rad/s.
    #[must_use]
    pub fn velocity_rad_s(&self) -> &Joints {
        self.of(LimitKind::Velocity)
    }

    /// Joint acceleration limits, in rad/s^2.
    #[must_use]
    pub fn acceleration_rad_s2(&self) -> &Joints {
        self.of(LimitKind::Acceleration)
    }

    /// Joint jerk limits, in rad/s^3.
    #[must_use]
    pub fn jerk_rad_s3(&self) -> &Joints {
        self.of(LimitKind::Jerk)
    }
}
