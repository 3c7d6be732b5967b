//! What a path consists of.

use std::sync::Arc;

use crate::segment::Segment;
use iiwa_program::{MotionIndex, MotionLimits};

/// One thing that the arm does.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Step {
    /// It moves, within the limits of `motion`.
    Move {
        /// The motion whose limits hold, if there are no others. In a blend it is the following one: measured for speed
        /// (Larsen 2019, Appendix B), assumed for acceleration and jerk.
        motion: MotionIndex,
        /// Where it moves.
        segment: Arc<dyn Segment>,
        /// The corner, if this is a blend.
        blend: Option<Corner>,
        /// Other limits than the motion's: those of a spline's segment that has its own.
        limits: Option<Arc<MotionLimits>>,
    },
    /// It stops and goes on at once: a corner that no blend rounds.
    Corner {
        /// The motion that has ended.
        motion: MotionIndex,
    },
    /// It stands until it has settled, at the end of `motion` (Larsen 2019, Appendix C).
    Settle {
        /// The motion that has ended.
        motion: MotionIndex,
        /// Whether the program waits for that end before it sends the next motion.
        blocking: bool,
        /// Whether the motion goes nowhere.
        still: bool,
    },
    /// It waits.
    Wait {
        /// The wait's place in the program.
        motion: MotionIndex,
        /// For how long, in s.
        seconds: f64,
    },
}

impl Step {
    /// Whether the arm moves.
    #[must_use]
    pub fn moves(&self) -> bool {
        matches!(self, Self::Move { .. })
    }

    /// The motion that it belongs to: in a blend the following one.
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

/// What a blend rounds off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// The motion whose target is blended away.
    pub motion: MotionIndex,
    /// Angle between the two directions in joint space, in degrees: 0 straight on, 180 turned back
    /// (Larsen 2019, Eq. 28).
    pub gamma_deg: f64,
}
