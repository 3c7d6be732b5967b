//! Steps of a path.

use std::sync::Arc;

use crate::segment::Segment;
use iiwa_program::{MotionIndex, MotionLimits};

/// One step of the robot.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Step {
    /// Motion along a segment, within the limits of `motion`.
    Move {
        /// The motion whose limits apply, unless the step has its own. In a blend it is the
        /// following motion: measured for velocity (Larsen 2019, Appendix B), assumed for
        /// acceleration and jerk.
        motion: MotionIndex,
        /// The curve.
        segment: Arc<dyn Segment>,
        /// The corner, if the segment is a blend.
        blend: Option<Corner>,
        /// Limits in place of those of the motion: those of a spline segment with its own limits.
        limits: Option<Arc<MotionLimits>>,
    },
    /// Stop without a dwell, at a corner without a blend (the struct [`Corner`] is a corner with a
    /// blend).
    Corner {
        /// The motion that has ended.
        motion: MotionIndex,
    },
    /// Standstill until the robot has settled, at the end of `motion` (Larsen 2019, Appendix C).
    Settle {
        /// The motion that has ended.
        motion: MotionIndex,
        /// `true` if the program waits for the end of the motion before it sends the next one.
        blocking: bool,
        /// `true` if the motion has zero length.
        still: bool,
    },
    /// Wait at rest.
    Wait {
        /// The index of the wait in the program.
        motion: MotionIndex,
        /// Duration, in s.
        seconds: f64,
    },
}

impl Step {
    /// True if the robot moves.
    #[must_use]
    pub fn moves(&self) -> bool {
        matches!(self, Self::Move { .. })
    }

    /// The motion of the step: in a blend the following one.
    #[must_use]
    pub fn motion(&self) -> MotionIndex {
        match self {
            Self::Move { motion, .. }
            | Self::Corner { motion }
            | Self::Settle { motion, .. }
            | Self::Wait { motion, .. } => *motion,
        }
    }
}

/// A corner that a blend rounds off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// The motion whose target is blended away.
    pub motion: MotionIndex,
    /// Angle between the directions before and after the corner, in degrees: 0 straight on, 180
    /// turned back (Larsen 2019, Eq. 28). These are TCP directions in a blend between two
    /// paths of one TCP on which the wrist joints are not interpolated, otherwise directions in
    /// joint space.
    pub gamma_deg: f64,
}
