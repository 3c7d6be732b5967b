//! Steps of a path.

use std::{fmt, sync::Arc};

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
        /// Place of the stop, if it is within a spline.
        place: Option<SplineStop>,
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
            | Self::Corner { motion, .. }
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
    /// Difference from the radius in the program, if the blend is smaller.
    pub shortened: Option<ShortenedBlend>,
}

/// Radius of a blend that would exceed half of a motion or, next to a spline, half of the spline's
/// first or last segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShortenedBlend {
    /// The motion of which the blend takes half.
    pub half_of: MotionIndex,
    /// Radius in the program, in mm.
    pub asked_mm: f64,
    /// Distance of the TCP from the target at the end of the blend, in mm.
    pub used_mm: f64,
}

/// Difference from the radius in the program from which a blend counts as shortened, in mm: radii
/// are printed to a tenth.
const MIN_DIFFERENCE_MM: f64 = 0.05;

impl ShortenedBlend {
    /// Returns the radius of a blend that takes half of a motion; `None` if the blend is as large
    /// as the program asks for.
    pub(crate) fn new(half_of: MotionIndex, asked_mm: f64, used_mm: f64) -> Option<Self> {
        (asked_mm - used_mm >= MIN_DIFFERENCE_MM).then_some(Self { half_of, asked_mm, used_mm })
    }

    /// Returns the smaller of two radii.
    pub(crate) fn smaller(self, other: Self) -> Self {
        if other.used_mm < self.used_mm { other } else { self }
    }
}

/// Place at which the TCP stops within a spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplineStop {
    /// Within the segment with this number, from 1.
    Within(usize),
    /// At the end of the segment with this number, from 1.
    After(usize),
}

impl fmt::Display for SplineStop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Within(segment) => write!(f, "within segment {segment}"),
            Self::After(segment) => write!(f, "after segment {segment}"),
        }
    }
}
