//! What can be wrong with a motion to a frame.

use iiwa_kin::{OutsideRange, SingularPart, Unreachable};

use crate::{limit_kind::percent, workcell::NameFault};

/// Something in a motion to a frame that cannot be planned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CartesianFault {
    /// A name leads nowhere.
    #[error(transparent)]
    Name(#[from] NameFault),
    /// No joints reach the frame.
    #[error("the frame is {0}")]
    Unreachable(#[from] Unreachable),
    /// The joints that reach the frame are outside their ranges.
    #[error("at the frame, {0}")]
    Outside(OutsideRange),
    /// There is no such line or circle.
    #[error(transparent)]
    Course(#[from] CourseFault),
    /// The arm does not reach the path everywhere.
    #[error("at {:.1} % of the way, the path is {reason}", 100.0 * .s)]
    UnreachableOnTheWay {
        /// Where, as a share of the way.
        s: f64,
        /// Why.
        reason: Unreachable,
    },
    /// A joint leaves its range on the way.
    #[error("at {:.1} % of the way, {outside}{}", 100.0 * .s, hint(*.other_e1_deg))]
    OutsideOnTheWay {
        /// Where it is farthest outside, as a share of the way.
        s: f64,
        /// Which joint, and its range.
        outside: OutsideRange,
        /// E1 at the target, in degrees, with which the motion can be done; if one was found.
        other_e1_deg: Option<f64>,
    },
    /// The path comes too near to a singular pose.
    #[error(
        "at {:.1} % of the way, the arm is singular: {}{}", 100.0 * .s, what(*.part), hint(*.other_e1_deg)
    )]
    Singular {
        /// Where, as a share of the way.
        s: f64,
        /// Which part of the arm; none where the joints turn too abruptly to tell.
        part: Option<SingularPart>,
        /// E1 at the target, in degrees, with which the motion stays away from it; if one was found.
        other_e1_deg: Option<f64>,
    },
    /// A limit of the TCP is next to nothing, or less.
    #[error("{key} is {found}; it must be at least {min}")]
    Limit {
        /// The limit's key in programs.
        key: &'static str,
        /// What it is.
        found: f64,
        /// What it has to be at least.
        min: f64,
    },
    /// A share of the joints' limits is not in (0, 1], or next to nothing.
    #[error("{key} is {found}; it must be at least {min} and at most 1{}", percent(*.found))]
    Share {
        /// The share's key in programs.
        key: &'static str,
        /// What it is.
        found: f64,
        /// What it has to be at least.
        min: f64,
    },
    /// A circle's angle is zero or beyond a full turn.
    #[error("circ_angle_deg is {found_deg}; it must be from -360 to 360, and not 0")]
    CircAngle {
        /// What it is, in degrees.
        found_deg: f64,
    },
    /// The auxiliary orientation is to be reached at the auxiliary frame, on a circle with an angle.
    #[error("aux_orientation cannot be `interpolate` on a circle with circ_angle_deg")]
    AuxWithAngle,
    /// A spline has no segments, or more than a controller takes.
    #[error("the spline has {found} segments; it must have from 1 to {max}")]
    Segments {
        /// How many it has.
        found: usize,
        /// How many it may have.
        max: usize,
    },
    /// The orientation is ignored on a motion that is no segment of a spline.
    #[error("orientation `ignore` is for the segments of a spline; give `variable` or `constant`")]
    IgnoredOrientation,
    /// The wrist is to turn by itself on a spline.
    #[error("orientation `ori_joint` is for lin, lin_rel and circ, not for splines")]
    WristInSpline,
    /// The wrist turns by itself, and shoulder or elbow would have to change sides on the way.
    #[error(
        "with orientation `ori_joint` the arm stays on its side of shoulder and elbow, and at the target it would be on \
         another; of the status, only bit 4 may change"
    )]
    OtherSide,
    /// A segment of a spline cannot be planned.
    #[error("segment {}: {fault}", .index + 1)]
    Segment {
        /// Its place among the segments, from 0.
        index: usize,
        /// The key of the segment at which it is.
        key: &'static str,
        /// What is wrong.
        fault: Box<CartesianFault>,
    },
    /// A blend of a path has a size that is for other motions.
    #[error("{0}")]
    Blend(&'static str),
}

/// What a circle and the frames on it cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CourseFault {
    /// The orientations differ by half a turn.
    #[error(
        "the orientation would turn by half a turn: the way round is not defined; add a frame in between, or turn a \
         little less"
    )]
    HalfTurn,
    /// Start, auxiliary frame and end are on a line, or two of them are the same.
    #[error("start, auxiliary frame and end are on one line: no circle goes through them")]
    NoCircle,
}

impl CartesianFault {
    /// Whether the motion is well formed and the arm cannot do it.
    pub(crate) fn is_of_the_arm(&self) -> bool {
        match self {
            Self::Unreachable(_)
            | Self::Outside(_)
            | Self::UnreachableOnTheWay { .. }
            | Self::OutsideOnTheWay { .. }
            | Self::Singular { .. }
            | Self::OtherSide => true,
            Self::Segment { fault, .. } => fault.is_of_the_arm(),
            Self::Name(_)
            | Self::Course(_)
            | Self::Limit { .. }
            | Self::Share { .. }
            | Self::CircAngle { .. }
            | Self::AuxWithAngle
            | Self::Segments { .. }
            | Self::IgnoredOrientation
            | Self::WristInSpline
            | Self::Blend(_) => false,
        }
    }

    /// The same without another E1: on a spline that would change the segments around, too.
    #[must_use]
    pub fn without_hint(self) -> Self {
        match self {
            Self::OutsideOnTheWay { s, outside, .. } => {
                Self::OutsideOnTheWay { s, outside, other_e1_deg: None }
            }
            Self::Singular { s, part, .. } => Self::Singular { s, part, other_e1_deg: None },
            other => other,
        }
    }
}

fn what(part: Option<SingularPart>) -> &'static str {
    match part {
        Some(SingularPart::Shoulder) => "the wrist passes over joint A1, and E1 cannot be kept",
        Some(SingularPart::Elbow) => "A4 is at 0 and the arm stretched",
        Some(SingularPart::Wrist) => "A6 is at 0 and the flange in line with the forearm",
        None => "joints would have to turn abruptly",
    }
}

fn hint(other_e1_deg: Option<f64>) -> String {
    match other_e1_deg {
        Some(e1_deg) => format!("; with E1 at {e1_deg:.0} deg at the target it can be done"),
        None => "; move the frame, or go there by ptp".to_owned(),
    }
}
