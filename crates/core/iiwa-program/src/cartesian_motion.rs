//! Motions to frames and along TCP paths.

use iiwa_kin::Joints;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    blend::Blend,
    cartesian_fault::CartesianFault,
    limit_kind::{ByKind, MIN_SHARE, is_share},
    target::{Frame, TargetRef},
    tool_limits::ToolLimits,
};

/// A motion whose end is given as a TCP frame.
///
/// ```
/// use iiwa_program::{CartesianMotion, Course, Frame};
///
/// let frame = Frame { xyz_mm: [500.0, 100.0, 400.0], abc_rad: [0.0, 0.0, 3.1] };
/// let lin = CartesianMotion::new(Course::Lin { to: frame.into() });
/// assert_eq!(lin.tool, None);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CartesianMotion {
    /// Course, with its targets.
    pub course: Course,
    /// Moved TCP, `TOOL` or `TOOL/TIP`, or `flange`; the program's by default.
    pub tool: Option<String>,
    /// Base of frames in this motion that name no base; the program's by default.
    pub base: Option<String>,
    /// Share of each joint's limit of each kind, in (0, 1].
    pub shares: ByKind<Joints>,
    /// TCP limits.
    pub tool_limits: ToolLimits,
    /// Orientation interpolation; used on TCP paths only.
    pub orientation: OrientationType,
    /// Blend at the target; without a blend the robot stops there and settles.
    pub blend: Option<PathBlend>,
    /// `true` if the program waits for the end of the motion before it sends the next one, which
    /// lengthens the standstill. Not allowed together with a blend.
    pub blocking: bool,
}

/// Course of a motion to a frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// Point to point: a straight line in joint space.
    Ptp {
        /// Target frame.
        to: TargetRef,
    },
    /// Straight TCP line.
    Lin {
        /// Target frame.
        to: TargetRef,
    },
    /// Straight TCP line by an offset.
    LinRel {
        /// Offset, in the orientation of `within`.
        offset: Frame,
        /// Position of A3 at the end, in rad; as at the start by default.
        e1_rad: Option<f64>,
        /// Frame or base in whose orientation the offset is given; that of the TCP at the start by
        /// default. Resolved by [`Workcell::reference`](crate::Workcell::reference).
        within: Option<TargetRef>,
    },
    /// TCP circle.
    Circ(Circ),
    /// Path through the ends of segments without a stop; at most [`MAX_SEGMENTS`] segments.
    Spline(Vec<SplineSegment>),
}

/// Largest number of spline segments, as on the robot controller.
pub const MAX_SEGMENTS: usize = 20;

/// A spline segment.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineSegment {
    /// Course, with its targets.
    pub course: SegmentCourse,
    /// Orientation interpolation; the spline's by default.
    pub orientation: Option<OrientationType>,
    /// Limits of the segment.
    pub limits: SegmentLimits,
}

/// Limits of a spline segment; the spline's limits by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SegmentLimits {
    /// Share of each joint's limit, in (0, 1].
    pub shares: ByKind<Option<Joints>>,
    /// TCP limits; infinite if the spline's limits apply.
    pub tool: ToolLimits,
}

/// Course of a spline segment.
#[derive(Clone, Debug, PartialEq)]
pub enum SegmentCourse {
    /// A curve defined by the frames of the spline.
    Spl {
        /// Target frame.
        to: TargetRef,
    },
    /// A straight line.
    Lin {
        /// Target frame.
        to: TargetRef,
    },
    /// A circle.
    Circ(Circ),
}

impl SegmentCourse {
    /// Target frame.
    #[must_use]
    pub fn target(&self) -> &TargetRef {
        match self {
            Self::Spl { to } | Self::Lin { to } => to,
            Self::Circ(circ) => &circ.to,
        }
    }
}

/// A circle through the start of the motion, an auxiliary frame and an end frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Circ {
    /// Auxiliary frame, between start and end frame.
    pub aux: TargetRef,
    /// End frame of the circle.
    pub to: TargetRef,
    /// Angle of the arc, in rad, from the start through the auxiliary frame: the arc may end beyond
    /// or before the end frame; negative in the opposite direction. The arc ends at the end frame
    /// by default.
    pub angle_rad: Option<f64>,
    /// `true` if the orientation turns with the path; otherwise it is given in the base.
    pub turns_with_path: bool,
    /// Use of the auxiliary frame's orientation.
    pub aux_orientation: AuxOrientation,
    /// `true` if the orientation of the end frame is reached there and extrapolated beyond;
    /// otherwise it is reached at the end of the motion.
    pub extrapolates: bool,
}

/// Interpolation of the orientation along a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum OrientationType {
    /// One rotation about a fixed axis, uniform along the path.
    #[default]
    Variable,
    /// As at the start.
    Constant,
    /// Joints A5 to A7 move uniformly to their target positions; not for splines.
    #[serde(rename = "ori_joint")]
    Joints,
    /// Only on spline segments: the orientation at the end is interpolated between its neighbours.
    Ignore,
}

/// Use of the auxiliary frame's orientation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AuxOrientation {
    /// Reached somewhere on the path.
    #[default]
    Consider,
    /// Reached at the auxiliary frame.
    Interpolate,
    /// Ignored.
    Ignore,
}

/// Blend size of a motion to a frame. Of several sizes, the smallest zone applies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathBlend {
    /// Distance from the target, in mm; below 4 the robot stops.
    pub cart_mm: Option<f64>,
    /// Largest deviation of the orientation from the target's, in rad; not for point-to-point
    /// motions.
    pub orientation_rad: Option<f64>,
    /// Sunrise's `setBlendingRel`, 0 to 1. On TCP paths it applies to the redundancy only, and the
    /// blend is as small as possible.
    pub sunrise_rel: Option<f64>,
    /// Share of both motions, 0 to 0.5; for point-to-point motions only.
    pub fraction: Option<f64>,
}

impl CartesianMotion {
    /// Motion at full speed that ends in a stop.
    #[must_use]
    pub fn new(course: Course) -> Self {
        Self {
            course,
            tool: None,
            base: None,
            shares: ByKind::from_fn(|_| [1.0; 7]),
            tool_limits: ToolLimits::NONE,
            orientation: OrientationType::default(),
            blend: None,
            blocking: false,
        }
    }

    /// Checks the number and the limits of spline segments, and that a motion other than a spline
    /// has no orientation that is only for segments.
    pub(crate) fn check_segments(&self) -> Result<(), (&'static str, CartesianFault)> {
        match &self.course {
            Course::Spline(segments) if !(1..=MAX_SEGMENTS).contains(&segments.len()) => Err((
                "segments",
                CartesianFault::Segments { found: segments.len(), max: MAX_SEGMENTS },
            )),
            Course::Spline(segments) => {
                let segment_laws = segments.iter().filter_map(|segment| segment.orientation);
                if segment_laws.chain([self.orientation]).any(|law| law == OrientationType::Joints)
                {
                    return Err(("orientation", CartesianFault::WristInSpline));
                }
                segments.iter().enumerate().try_for_each(|(index, segment)| {
                    segment.limits.check().map_err(|(key, fault)| {
                        let fault = Box::new(fault);
                        ("segments", CartesianFault::Segment { index, key, fault })
                    })
                })
            }
            _ if self.orientation == OrientationType::Ignore => {
                Err(("orientation", CartesianFault::IgnoredOrientation))
            }
            _ => Ok(()),
        }
    }

    /// Returns true if the motion is written as a single `spl` motion instead of a spline of one
    /// segment.
    #[must_use]
    pub fn is_single_spl(&self) -> bool {
        let Course::Spline(segments) = &self.course else { return false };
        let single = |segment: &SplineSegment| {
            matches!(segment.course, SegmentCourse::Spl { .. })
                && segment.orientation.is_none()
                && segment.limits == SegmentLimits::default()
        };
        segments.len() == 1 && segments.iter().all(single)
    }

    /// Program key of the end of the motion.
    #[must_use]
    pub fn end_key(&self) -> &'static str {
        if matches!(self.course, Course::LinRel { .. }) { "offset" } else { "frame" }
    }

    /// Returns true if the path is straight in joint space.
    #[must_use]
    pub fn is_ptp(&self) -> bool {
        matches!(self.course, Course::Ptp { .. })
    }

    /// Target frame; `None` for a motion by an offset.
    #[must_use]
    pub fn target(&self) -> Option<&TargetRef> {
        match &self.course {
            Course::Ptp { to } | Course::Lin { to } => Some(to),
            Course::Circ(circ) => Some(&circ.to),
            Course::Spline(segments) => segments.last().map(|segment| segment.course.target()),
            Course::LinRel { .. } => None,
        }
    }
}

impl SegmentLimits {
    /// Checks the limits; returns the first that is too small or out of range.
    pub(crate) fn check(&self) -> Result<(), (&'static str, CartesianFault)> {
        for (kind, shares) in &self.shares {
            if let Some(&found) = shares.iter().flatten().find(|share| !is_share(**share)) {
                let key = kind.share_key();
                return Err((key, CartesianFault::Share { key, found, min: MIN_SHARE }));
            }
        }
        self.tool.check()
    }
}

impl PathBlend {
    /// Blend within a distance of the target, in mm.
    #[must_use]
    pub fn cart_mm(radius_mm: f64) -> Self {
        Self { cart_mm: Some(radius_mm), ..Self::default() }
    }

    /// Checks that the sizes are allowed for a point-to-point motion, or for a TCP path.
    pub(crate) fn check(&self, is_ptp: bool) -> Result<(), CartesianFault> {
        let wrong = |message| Err(CartesianFault::Blend(message));
        if is_ptp {
            if self.orientation_rad.is_some() {
                return wrong("ori_deg is for TCP paths: a point-to-point motion cannot have it");
            }
            if self.sizes().count() != 1 {
                return wrong("a blend has exactly one of `fraction`, `sunrise_rel` and `cart_mm`");
            }
        } else if self.fraction.is_some() {
            return wrong("fraction is for point-to-point motions; give cart_mm or ori_deg");
        } else if self.orientation_rad.is_some_and(|angle| angle.is_nan() || angle < 0.0) {
            return wrong("ori_deg must be 0 or more");
        } else if self.orientation_rad.is_none() && self.sizes().count() == 0 {
            return wrong("a blend has at least one of `cart_mm`, `ori_deg` and `sunrise_rel`");
        }
        Ok(())
    }

    fn sizes(&self) -> impl Iterator<Item = Blend> {
        let sizes = [
            self.cart_mm.map(Blend::CartMm),
            self.sunrise_rel.map(Blend::SunriseRel),
            self.fraction.map(Blend::Fraction),
        ];
        sizes.into_iter().flatten()
    }

    /// Converts to the blend of a point-to-point motion.
    #[must_use]
    pub fn in_joints(&self) -> Option<Blend> {
        self.sizes().next()
    }
}

impl From<Blend> for PathBlend {
    fn from(blend: Blend) -> Self {
        let none = Self::default();
        match blend {
            Blend::Fraction(b) => Self { fraction: Some(b), ..none },
            Blend::SunriseRel(x) => Self { sunrise_rel: Some(x), ..none },
            Blend::CartMm(r) => Self { cart_mm: Some(r), ..none },
        }
    }
}
