//! The types of motions.

use crate::{cartesian_motion::Course, program::Motion};

/// The types of motions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MotionType {
    /// Point to point, to joint positions.
    #[default]
    Ptp,
    /// Point to point, to a frame.
    PtpToFrame,
    /// The TCP goes straight to a frame.
    Lin,
    /// The TCP goes straight, by an offset.
    LinRel,
    /// The TCP goes on a circle.
    Circ,
    /// The TCP goes through frames on segments of a spline.
    Spline,
    /// The TCP goes on a spline of one segment.
    Spl,
    /// A wait.
    Wait,
    /// A change of the load.
    Load,
}

impl MotionType {
    /// Its name in programs: `ptp`, `lin`, `lin_rel`, `circ`, `spline`, `spl`, `wait` or `load`.
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

    /// The type of a name; of `ptp`, that to joint positions.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let tcp = [Self::Lin, Self::LinRel, Self::Circ, Self::Spline, Self::Spl];
        let mut all = [Self::Ptp, Self::Wait, Self::Load].into_iter().chain(tcp);
        all.find(|motion| motion.name() == name)
    }

    /// Whether its target is a frame of the TCP.
    #[must_use]
    pub fn is_cartesian(self) -> bool {
        !matches!(self, Self::Ptp | Self::Wait | Self::Load)
    }
}

impl Motion {
    /// Its type.
    #[must_use]
    pub fn motion_type(&self) -> MotionType {
        match self {
            Self::Ptp(_) => MotionType::Ptp,
            Self::Wait { .. } => MotionType::Wait,
            Self::Load(_) => MotionType::Load,
            Self::Cartesian(own) => match own.course {
                Course::Ptp { .. } => MotionType::PtpToFrame,
                Course::Lin { .. } => MotionType::Lin,
                Course::LinRel { .. } => MotionType::LinRel,
                Course::Circ(_) => MotionType::Circ,
                Course::Spline(_) if own.is_single_spl() => MotionType::Spl,
                Course::Spline(_) => MotionType::Spline,
            },
        }
    }
}
