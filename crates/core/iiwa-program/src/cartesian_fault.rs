//! Faults of motions to frames.

use iiwa_kin::{OutsideRange, Pose, Robot, SingularPart, Status, Unreachable};

use crate::{limit_kind::percent, workcell::NameFault};

/// Fault: a motion to a frame cannot be planned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CartesianFault {
    /// A tool, base or frame name is unknown.
    #[error(transparent)]
    Name(#[from] NameFault),
    /// The frame is out of reach.
    #[error("the frame is {0}")]
    Unreachable(#[from] Unreachable),
    /// The joint positions at the frame are outside the joint ranges.
    #[error("at the frame, {}{}", exceeded(.outside), allowed_e1(*.e1_rad, .allowed_e1_rad))]
    Outside {
        /// Joint found outside, and its range.
        outside: OutsideRange,
        /// E1 at the frame, in rad.
        e1_rad: f64,
        /// Ranges of E1, in rad, in which all joints are within their ranges with the same status;
        /// empty if no such range exists.
        allowed_e1_rad: Vec<[f64; 2]>,
    },
    /// The course is not defined, see [`CourseFault`].
    #[error(transparent)]
    Course(#[from] CourseFault),
    /// The path is out of reach somewhere.
    #[error("at {:.1} % of the way, the path is {reason}", 100.0 * .s)]
    UnreachableOnTheWay {
        /// Position of the fault, as a share of the path length.
        s: f64,
        /// Reason.
        reason: Unreachable,
    },
    /// A joint leaves its range along the path.
    #[error("at {:.1} % of the way, {}{}", 100.0 * .s, exceeded(.outside), hint(*.other_e1_deg))]
    OutsideOnTheWay {
        /// Position of the largest excess, as a share of the path length.
        s: f64,
        /// Joint found outside, and its range.
        outside: OutsideRange,
        /// E1 at the target, in degrees, with which the motion is feasible, if one was found.
        other_e1_deg: Option<f64>,
    },
    /// The path is too close to a singular pose.
    #[error(
        "at {:.1} % of the way, the arm is singular: {}{}",
        100.0 * .s,
        description(*.part),
        hint(*.other_e1_deg)
    )]
    Singular {
        /// Position of the fault, as a share of the path length.
        s: f64,
        /// Singular part of the arm; `None` if the joints turn too abruptly to identify the part.
        part: Option<SingularPart>,
        /// E1 at the target, in degrees, with which the motion avoids the singularity, if one was
        /// found.
        other_e1_deg: Option<f64>,
    },
    /// A TCP limit is below its minimum.
    #[error("{key} is {found}; it must be at least {min}")]
    Limit {
        /// Key of the limit in programs.
        key: &'static str,
        /// Value found.
        found: f64,
        /// Smallest accepted value.
        min: f64,
    },
    /// A share of the joint limits is not in (0, 1], or below its minimum.
    #[error("{key} is {found}; it must be at least {min} and at most 1{}", percent(*.found))]
    Share {
        /// Key of the share in programs.
        key: &'static str,
        /// Value found.
        found: f64,
        /// Smallest accepted value.
        min: f64,
    },
    /// The angle of a circle is zero or beyond a full turn.
    #[error("circ_angle_deg is {found_deg}; it must be from -360 to 360, and not 0")]
    CircAngle {
        /// Angle found, in degrees.
        found_deg: f64,
    },
    /// `interpolate` for the auxiliary orientation is combined with a circle angle.
    #[error("aux_orientation cannot be `interpolate` on a circle with circ_angle_deg")]
    AuxWithAngle,
    /// A spline has no segments, or more than a controller accepts.
    #[error("the spline has {found} segments; it must have from 1 to {max}")]
    Segments {
        /// Number of segments found.
        found: usize,
        /// Largest accepted number of segments.
        max: usize,
    },
    /// The orientation is ignored on a motion that is not a spline segment.
    #[error("orientation `ignore` is for the segments of a spline; give `variable` or `constant`")]
    IgnoredOrientation,
    /// Interpolation of the wrist joints is requested on a spline.
    #[error("orientation `ori_joint` is for lin, lin_rel and circ, not for splines")]
    WristInSpline,
    /// With interpolated wrist joints, the shoulder or the elbow would have to change sides.
    #[error(
        "with orientation `ori_joint` the arm stays on its side of shoulder and elbow, and at the \
         target it would be on another; of the status, only bit 4 may change"
    )]
    OtherSide,
    /// A spline segment cannot be planned.
    #[error("segment {}: {fault}", .index + 1)]
    Segment {
        /// Index among the segments, from 0.
        index: usize,
        /// Key of the segment at which the fault is.
        key: &'static str,
        /// Fault of the segment.
        fault: Box<CartesianFault>,
    },
    /// A blend has a size that is only for other types of motions.
    #[error("{0}")]
    Blend(&'static str),
}

/// Fault: a circle, or the frames on it, is not defined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CourseFault {
    /// The orientations differ by half a turn.
    #[error(
        "the orientation would turn by half a turn: the way round is not defined; add a frame in \
         between, or turn a little less"
    )]
    HalfTurn,
    /// Start, auxiliary frame and end are collinear, or two of them coincide.
    #[error("start, auxiliary frame and end are on one line: no circle passes through them")]
    NoCircle,
}

impl CartesianFault {
    /// Fault of joint positions at a flange pose that are outside their ranges.
    #[must_use]
    pub fn outside(
        robot: &Robot,
        flange: &Pose,
        e1_rad: f64,
        status: Status,
        outside: OutsideRange,
    ) -> Self {
        let allowed_e1_rad = robot.allowed_e1(flange, status).unwrap_or_default();
        Self::Outside { outside, e1_rad, allowed_e1_rad }
    }

    /// Returns true if the motion is well formed but infeasible for the robot.
    pub(crate) fn is_of_the_arm(&self) -> bool {
        match self {
            Self::Unreachable(_)
            | Self::Outside { .. }
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

    /// Removes the suggestion of another E1, which on a spline would change the neighbouring
    /// segments, too.
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

/// A joint outside its range, with the excess.
fn exceeded(outside: &OutsideRange) -> String {
    format!("{outside}, exceeded by {} deg", rounded_up(outside.excess_deg()))
}

/// A positive number of degrees, to three decimals and not less.
fn rounded_up(deg: f64) -> f64 {
    let rounded = (deg * 1e3 - 1e-6).ceil() / 1e3;
    if rounded.is_finite() { rounded } else { deg }
}

/// E1 at a frame, and the ranges of E1 that are possible there.
fn allowed_e1(e1_rad: f64, allowed_rad: &[[f64; 2]]) -> String {
    let e1_deg = (e1_rad.to_degrees() * 1e3).round() / 1e3;
    let ranges: Vec<String> = allowed_rad
        .iter()
        // Rounded inwards, which leaves out ranges that are too narrow for a tenth.
        .map(|[from, to]| {
            [
                from.to_degrees().mul_add(10.0, -1e-6).ceil(),
                to.to_degrees().mul_add(10.0, 1e-6).floor(),
            ]
        })
        .filter(|[from, to]| from <= to)
        .map(|range| range.map(|tenths| tenths / 10.0 + 0.0))
        .map(|[from, to]| format!("{from} to {to} deg"))
        .collect();
    if ranges.is_empty() {
        format!("; E1 is {e1_deg} deg there, and no other E1 helps with this status")
    } else {
        let ranges = ranges.join(", or from ");
        format!("; E1 is {e1_deg} deg there, and has to be from {ranges} with this status")
    }
}

fn description(part: Option<SingularPart>) -> &'static str {
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
