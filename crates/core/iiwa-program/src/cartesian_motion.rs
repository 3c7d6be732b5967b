//! Motions to frames, and along paths of the TCP.

use iiwa_kin::Joints;

use crate::{
    blend::Blend, cartesian_fault::CartesianFault, frame::Frame, limit_kind::ByKind,
    segment_limits::SegmentLimits, target::TargetRef, tool_limits::ToolLimits,
};

/// A motion whose end is given as a frame of the TCP.
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
    /// On which course it goes where.
    pub course: Course,
    /// The TCP that moves, `TOOL` or `TOOL/TIP`, or `flange`; the program's if absent.
    pub tool: Option<String>,
    /// The base of frames that are given in the motion and name no other; the program's if absent.
    pub base: Option<String>,
    /// Share of each joint's limit of each kind, in (0, 1].
    pub shares: ByKind<Joints>,
    /// Limits of the TCP.
    pub tool_limits: ToolLimits,
    /// How the orientation goes along; it counts on paths of the TCP only.
    pub orientation: OrientationType,
    /// How the target is blended away; without it the arm stops there and settles.
    pub blend: Option<PathBlend>,
    /// Whether the program waits for its end before it sends the next motion: then the arm stands longer. A motion with a
    /// blend cannot have it.
    pub blocking: bool,
}

/// The course of a motion to a frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// Point to point: straight in joint space.
    Ptp {
        /// The frame.
        to: TargetRef,
    },
    /// The TCP goes straight.
    Lin {
        /// The frame.
        to: TargetRef,
    },
    /// The TCP goes straight, by an offset.
    LinRel {
        /// The offset, in the orientation of `within`.
        offset: Frame,
        /// The position of A3 at the end, in rad; as at the start if absent.
        e1_rad: Option<f64>,
        /// In whose orientation the offset is given; that of the TCP at the start if absent.
        within: Option<TargetRef>,
    },
    /// The TCP goes on a circle.
    Circ(Circ),
    /// The TCP goes through the ends of segments without a stop, at most [`MAX_SEGMENTS`].
    Spline(Vec<SplineSegment>),
}

/// The most segments of a spline, as on the robot's controller.
pub const MAX_SEGMENTS: usize = 20;

/// A segment of a spline.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineSegment {
    /// On which course it goes where.
    pub course: SegmentCourse,
    /// How the orientation goes along; as the spline says if absent.
    pub orientation: Option<OrientationType>,
    /// Limits of its own.
    pub limits: SegmentLimits,
}

/// The course of a segment of a spline.
#[derive(Clone, Debug, PartialEq)]
pub enum SegmentCourse {
    /// A curve that the frames of the spline define.
    Spl {
        /// The frame that it goes to.
        to: TargetRef,
    },
    /// A straight line.
    Lin {
        /// The frame that it goes to.
        to: TargetRef,
    },
    /// A circle.
    Circ(Circ),
}

impl SegmentCourse {
    /// The frame that it goes to.
    #[must_use]
    pub fn target(&self) -> &TargetRef {
        match self {
            Self::Spl { to } | Self::Lin { to } => to,
            Self::Circ(circ) => &circ.to,
        }
    }
}

/// A circle through where the motion starts, an auxiliary frame and another.
#[derive(Clone, Debug, PartialEq)]
pub struct Circ {
    /// The auxiliary frame, on the way.
    pub aux: TargetRef,
    /// The frame that the circle goes to.
    pub to: TargetRef,
    /// The angle by which it goes on, in rad: from the start by way of the auxiliary frame, and beyond the end frame
    /// or not as far; negative the other way round. To the end frame if absent.
    pub angle_rad: Option<f64>,
    /// Whether the orientation turns with the path; else it is given in the base.
    pub turns_with_path: bool,
    /// What the orientation of the auxiliary frame is for.
    pub aux_orientation: AuxOrientation,
    /// Whether the orientation of the end frame is reached there and goes on beyond; else it is reached where the motion
    /// ends.
    pub extrapolates: bool,
}

/// How the orientation of the TCP goes along a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum OrientationType {
    /// One turn about a fixed axis, evenly along the path.
    #[default]
    Variable,
    /// As at the start.
    Constant,
    /// Joints A5 to A7 go evenly from their positions at the start to those at the target. It passes where A6 is 0; not for
    /// splines.
    Joints,
    /// On a segment of a spline: the orientation at its end is that between its neighbours'.
    Ignore,
}

/// What the orientation of a circle's auxiliary frame is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AuxOrientation {
    /// It is reached somewhere on the way.
    #[default]
    Consider,
    /// It is reached at the auxiliary frame.
    Interpolate,
    /// It does not count.
    Ignore,
}

/// How large a blend of a motion to a frame is. Where several sizes are given, the smallest zone counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathBlend {
    /// The distance from the target, in mm; below 4 the arm stops.
    pub cart_mm: Option<f64>,
    /// By how much the orientation may differ from the target's, in rad; not for point-to-point motions.
    pub orientation_rad: Option<f64>,
    /// Sunrise's `setBlendingRel`, 0 to 1. On paths of the TCP it counts for the redundancy only, and the blend is as
    /// small as can be.
    pub sunrise_rel: Option<f64>,
    /// A share of both motions, 0 to 0.5; for point-to-point motions only.
    pub fraction: Option<f64>,
}

impl CartesianMotion {
    /// At full speed, to a stop.
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

    /// Checks that a spline has as many segments as one can have, with limits that can be kept, and that no other motion has
    /// an orientation that is for them.
    pub(crate) fn check_segments(&self) -> Result<(), (&'static str, CartesianFault)> {
        match &self.course {
            Course::Spline(segments) if !(1..=MAX_SEGMENTS).contains(&segments.len()) => Err((
                "segments",
                CartesianFault::Segments { found: segments.len(), max: MAX_SEGMENTS },
            )),
            Course::Spline(segments) => {
                let own = segments.iter().filter_map(|segment| segment.orientation);
                if own.chain([self.orientation]).any(|law| law == OrientationType::Joints) {
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

    /// Whether it is written as a motion of its own, `spl`, and not as a spline of one segment.
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

    /// The key of a program that says where it ends.
    #[must_use]
    pub fn end_key(&self) -> &'static str {
        if matches!(self.course, Course::LinRel { .. }) { "offset" } else { "frame" }
    }

    /// Whether it is straight in joint space.
    #[must_use]
    pub fn is_ptp(&self) -> bool {
        matches!(self.course, Course::Ptp { .. })
    }

    /// The frame that it goes to; none if it goes by an offset.
    #[must_use]
    pub fn target(&self) -> Option<&TargetRef> {
        match &self.course {
            Course::Ptp { to } | Course::Lin { to } => Some(to),
            Course::Circ(circ) => Some(&circ.to),
            Course::Spline(segments) => segments.last().map(|segment| segment.course.target()),
            Course::LinRel { .. } => None,
        }
    }

    /// Its name in programs: `ptp`, `lin`, `lin_rel`, `circ`, `spline` or `spl`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self.course {
            Course::Ptp { .. } => "ptp",
            Course::Lin { .. } => "lin",
            Course::LinRel { .. } => "lin_rel",
            Course::Circ(_) => "circ",
            Course::Spline(_) if self.is_single_spl() => "spl",
            Course::Spline(_) => "spline",
        }
    }
}

impl PathBlend {
    /// A blend within a distance of the target, in mm.
    #[must_use]
    pub fn cart_mm(radius_mm: f64) -> Self {
        Self { cart_mm: Some(radius_mm), ..Self::default() }
    }

    /// Checks that it is one that a point-to-point motion, or a path of the TCP, can have.
    pub(crate) fn check(&self, is_ptp: bool) -> Result<(), CartesianFault> {
        let wrong = |what| Err(CartesianFault::Blend(what));
        if is_ptp {
            if self.orientation_rad.is_some() {
                return wrong(
                    "ori_deg is for paths of the TCP: a point-to-point motion cannot have it",
                );
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

    /// As a blend of a point-to-point motion.
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
