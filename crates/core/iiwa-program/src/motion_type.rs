//! Motion types.

use crate::{cartesian_motion::Course, program::Motion};

/// Type of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MotionType {
    /// Point to point, to joint positions.
    #[default]
    Ptp,
    /// Point to point, to a frame.
    PtpToFrame,
    /// Straight TCP line to a frame.
    Lin,
    /// Straight TCP line by an offset.
    LinRel,
    /// TCP circle.
    Circ,
    /// TCP spline of several segments.
    Spline,
    /// TCP spline of one segment.
    Spl,
    /// Wait.
    Wait,
    /// Payload change.
    Load,
}

impl MotionType {
    /// Name in programs: `ptp`, `lin`, `lin_rel`, `circ`, `spline`, `spl`, `wait` or `load`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ptp | Self::PtpToFrame => "ptp",
            Self::Lin => "lin",
            Self::LinRel => "lin_rel",
            Self::Circ => "circ",
            Self::Spline => "spline",
            Self::Spl => "spl",
            Self::Wait => "wait",
            Self::Load => "load",
        }
    }

    /// Motion type with a name; `ptp` gives the type to joint positions.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let tcp = [Self::Lin, Self::LinRel, Self::Circ, Self::Spline, Self::Spl];
        let mut all = [Self::Ptp, Self::Wait, Self::Load].into_iter().chain(tcp);
        all.find(|motion| motion.name() == name)
    }

    /// Returns true if the target is a TCP frame.
    #[must_use]
    pub fn is_cartesian(self) -> bool {
        !matches!(self, Self::Ptp | Self::Wait | Self::Load)
    }
}

impl Motion {
    /// Type of the motion.
    #[must_use]
    pub fn motion_type(&self) -> MotionType {
        match self {
            Self::Ptp(_) => MotionType::Ptp,
            Self::Wait { .. } => MotionType::Wait,
            Self::Load(_) => MotionType::Load,
            Self::Cartesian(cartesian) => match cartesian.course {
                Course::Ptp { .. } => MotionType::PtpToFrame,
                Course::Lin { .. } => MotionType::Lin,
                Course::LinRel { .. } => MotionType::LinRel,
                Course::Circ(_) => MotionType::Circ,
                Course::Spline(_) if cartesian.is_single_spl() => MotionType::Spl,
                Course::Spline(_) => MotionType::Spline,
            },
        }
    }
}
