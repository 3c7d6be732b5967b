//! JSON form of TCP paths.

use iiwa_json::{object, object_or_null_like};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use super::{
    by_name::word,
    exact::exact_deg,
    frames::{PoseWire, TCP, TargetRefWire},
    limits::limited_wire,
};
use crate::{
    cartesian_motion::{AuxOrientation, CartesianMotion, Circ, Course, OrientationType, PathBlend},
    frame::Frame,
    program::Motion,
    segment_limits::SegmentLimits,
    target::TargetRef,
};

/// Declares a TCP path type with the common keys of all TCP paths.
macro_rules! path_wire {
    (
        $(#[$meta:meta])* $name:ident, $tag:ident = $type:literal
        { $($(#[$field_meta:meta])* $field:ident: $field_type:ty,)* }
    ) => {
        #[derive(Default, Deserialize, Serialize, JsonSchema)]
        #[schemars(inline)]
        pub(super) enum $tag {
            #[default]
            #[serde(rename = $type)]
            Type,
        }

        limited_wire! {
            $(#[$meta])*
            $name {
                r#type: $tag,
                $($(#[$field_meta])* $field: $field_type,)*
                /// Moved TCP, `TOOL` or `TOOL/TIP`, or `flange`; the program's by default.
                #[serde(default, skip_serializing_if = "Option::is_none")]
                tool: Option<String>,
                /// Base of frames that name no base; the program's by default.
                #[serde(default, skip_serializing_if = "Option::is_none")]
                base: Option<String>,
                /// Orientation interpolation.
                #[serde(
                    default,
                    deserialize_with = "word",
                    skip_serializing_if = "OrientationWire::is_variable"
                )]
                orientation: OrientationWire,
            } {
                /// Blend at the target; without a blend the robot stops there.
                #[serde(
                    default,
                    deserialize_with = "crate::wire::cartesian::blend",
                    skip_serializing_if = "Option::is_none"
                )]
                blend: Option<PathBlendWire>,
                /// `true` if the program waits for the end of the motion before it sends the next
                /// one, like Sunrise's `move`: a longer pause follows. Not allowed together with a
                /// blend.
                #[serde(default, skip_serializing_if = "std::ops::Not::not")]
                blocking: bool,
                /// Source line of the motion.
                #[serde(
                    default,
                    deserialize_with = "iiwa_json::object_or_null",
                    skip_serializing_if = "Option::is_none"
                )]
                source: Option<crate::wire::source::SourceWire>,
            }
        }

        impl $name {
            pub(super) fn source_mut(&mut self) -> &mut Option<crate::wire::source::SourceWire> {
                &mut self.source
            }

            /// Converts to a motion on `course`.
            fn on(self, course: Course) -> Motion {
                let limits = self.limits();
                Motion::Cartesian(Box::new(CartesianMotion {
                    course,
                    tool: self.tool,
                    base: self.base,
                    shares: limits.shares.map(|_, share| share.unwrap_or([1.0; 7])),
                    tool_limits: limits.tool,
                    orientation: self.orientation.into(),
                    blend: self.blend.map(PathBlendWire::blend),
                    blocking: self.blocking,
                }))
            }

            /// Converts from `motion`, whose course is given by these fields.
            fn of(motion: &CartesianMotion, $($field: $field_type),*) -> Self {
                let full = [1.0; 7];
                let shares =
                    motion.shares.map(|_, share| Some(share).filter(|share| *share != full));
                let limits = SegmentLimits { shares, tool: motion.tool_limits };
                Self {
                    r#type: $tag::Type,
                    $($field,)*
                    tool: motion.tool.clone(),
                    base: motion.base.clone(),
                    orientation: motion.orientation.into(),
                    blend: motion.blend.map(PathBlendWire::from),
                    blocking: motion.blocking,
                    ..Self::default()
                }
                .with_limits(&limits)
            }
        }
    };
}

pub(super) use path_wire;

path_wire! {
    /// Straight TCP line to a frame.
    #[schemars(rename = "Lin")]
    LinWire, LinTag = "lin" {
        /// Target frame.
        frame: TargetRefWire,
    }
}

path_wire! {
    /// Straight TCP line by an offset.
    #[schemars(rename = "LinRel")]
    LinRelWire, LinRelTag = "lin_rel" {
        /// Offset of the TCP.
        #[serde(deserialize_with = "object")]
        offset: PoseWire,
        /// Frame in whose orientation the offset is given: `tcp`, or a frame.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        r#in: Option<TargetRefWire>,
        /// Position of joint A3 at the end, in degrees; as at the start by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        e1_deg: Option<f64>,
    }
}

path_wire! {
    /// TCP circle through an auxiliary frame.
    #[schemars(rename = "Circ")]
    CircWire, CircTag = "circ" {
        /// Auxiliary frame between start and end frame.
        aux: TargetRefWire,
        /// End frame of the circle.
        frame: TargetRefWire,
        /// Angle of the arc, in degrees; the arc ends at the end frame by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = -360, max = 360))]
        circ_angle_deg: Option<f64>,
        /// Reference of the orientation: the base, or the path.
        #[serde(default, deserialize_with = "word", skip_serializing_if = "ReferenceWire::is_base")]
        orientation_reference: ReferenceWire,
        /// Use of the auxiliary frame's orientation.
        #[serde(default, deserialize_with = "word", skip_serializing_if = "AuxWire::is_consider")]
        aux_orientation: AuxWire,
        /// Place where the end frame's orientation is reached, for an arc with an angle.
        #[serde(
            default,
            deserialize_with = "word",
            skip_serializing_if = "EndWire::is_interpolate"
        )]
        end_orientation: EndWire,
    }
}

/// Key of an error, and its message.
type Wrong = (&'static str, String);

impl LinWire {
    pub(super) fn motion(mut self) -> Result<Motion, Wrong> {
        let to = std::mem::take(&mut self.frame).target().map_err(|message| ("frame", message))?;
        Ok(self.on(Course::Lin { to }))
    }

    pub(super) fn new(motion: &CartesianMotion, to: &TargetRef) -> Self {
        Self::of(motion, to.into())
    }
}

impl LinRelWire {
    pub(super) fn motion(mut self) -> Result<Motion, Wrong> {
        let offset = self.offset.frame().map_err(|message| ("offset", message))?;
        let within = match self.r#in.take() {
            None => None,
            Some(TargetRefWire::Named(name)) if name == TCP => None,
            Some(within) => Some(within.target().map_err(|message| ("in", message))?),
        };
        let e1_rad = self.e1_deg.map(f64::to_radians);
        Ok(self.on(Course::LinRel { offset, e1_rad, within }))
    }

    pub(super) fn new(
        motion: &CartesianMotion,
        offset: &Frame,
        e1_rad: Option<f64>,
        within: Option<&TargetRef>,
    ) -> Self {
        let e1_deg = e1_rad.map(exact_deg);
        Self::of(motion, offset.into(), within.map(TargetRefWire::from), e1_deg)
    }
}

impl CircWire {
    pub(super) fn motion(mut self) -> Result<Motion, Wrong> {
        let aux = std::mem::take(&mut self.aux).target();
        let to = std::mem::take(&mut self.frame).target();
        let options = CircOptions {
            angle_deg: self.circ_angle_deg,
            reference: self.orientation_reference,
            aux: self.aux_orientation,
            end: self.end_orientation,
        };
        let [aux, to] =
            [aux.map_err(|message| ("aux", message))?, to.map_err(|message| ("frame", message))?];
        Ok(self.on(Course::Circ(options.circ(aux, to))))
    }

    pub(super) fn new(motion: &CartesianMotion, circ: &Circ) -> Self {
        let CircOptions { angle_deg, reference, aux, end } = circ.into();
        Self::of(motion, (&circ.aux).into(), (&circ.to).into(), angle_deg, reference, aux, end)
    }
}

/// Options of a circle, besides its frames.
pub(super) struct CircOptions {
    pub(super) angle_deg: Option<f64>,
    pub(super) reference: ReferenceWire,
    pub(super) aux: AuxWire,
    pub(super) end: EndWire,
}

impl CircOptions {
    pub(super) fn circ(self, aux: TargetRef, to: TargetRef) -> Circ {
        Circ {
            aux,
            to,
            angle_rad: self.angle_deg.map(f64::to_radians),
            turns_with_path: !self.reference.is_base(),
            aux_orientation: match self.aux {
                AuxWire::Consider => AuxOrientation::Consider,
                AuxWire::Interpolate => AuxOrientation::Interpolate,
                AuxWire::Ignore => AuxOrientation::Ignore,
            },
            extrapolates: !self.end.is_interpolate(),
        }
    }
}

impl From<&Circ> for CircOptions {
    fn from(circ: &Circ) -> Self {
        Self {
            angle_deg: circ.angle_rad.map(exact_deg),
            reference: if circ.turns_with_path { ReferenceWire::Path } else { ReferenceWire::Base },
            aux: match circ.aux_orientation {
                AuxOrientation::Consider => AuxWire::Consider,
                AuxOrientation::Interpolate => AuxWire::Interpolate,
                AuxOrientation::Ignore => AuxWire::Ignore,
            },
            end: if circ.extrapolates { EndWire::Extrapolate } else { EndWire::Interpolate },
        }
    }
}

/// Interpolation of the orientation along a path.
#[derive(Clone, Copy, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "OrientationType")]
pub(super) enum OrientationWire {
    /// One rotation about a fixed axis, uniform along the path.
    #[default]
    Variable,
    /// As at the start.
    Constant,
    /// Joints A5 to A7 move uniformly to their target positions; not for splines.
    OriJoint,
    /// Only on spline segments: the orientation at the end is interpolated between its neighbours.
    Ignore,
}

impl OrientationWire {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
    pub(super) fn is_variable(&self) -> bool {
        *self == Self::Variable
    }
}

impl From<OrientationWire> for OrientationType {
    fn from(wire: OrientationWire) -> Self {
        match wire {
            OrientationWire::Variable => Self::Variable,
            OrientationWire::Constant => Self::Constant,
            OrientationWire::OriJoint => Self::Joints,
            OrientationWire::Ignore => Self::Ignore,
        }
    }
}

impl From<OrientationType> for OrientationWire {
    fn from(orientation: OrientationType) -> Self {
        match orientation {
            OrientationType::Variable => Self::Variable,
            OrientationType::Constant => Self::Constant,
            OrientationType::Joints => Self::OriJoint,
            OrientationType::Ignore => Self::Ignore,
        }
    }
}

/// Reference of the orientation on a circle.
#[derive(Clone, Copy, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "OrientationReference")]
pub(super) enum ReferenceWire {
    /// The base.
    #[default]
    Base,
    /// A frame that turns with the path.
    Path,
}

impl ReferenceWire {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
    pub(super) fn is_base(&self) -> bool {
        *self == Self::Base
    }
}

/// Use of the auxiliary frame's orientation.
#[derive(Clone, Copy, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "AuxOrientation")]
pub(super) enum AuxWire {
    /// Reached somewhere on the path.
    #[default]
    Consider,
    /// Reached at the auxiliary frame.
    Interpolate,
    /// Ignored.
    Ignore,
}

impl AuxWire {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
    pub(super) fn is_consider(&self) -> bool {
        *self == Self::Consider
    }
}

/// Place where the orientation of the end frame is reached.
#[derive(Clone, Copy, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "EndOrientation")]
pub(super) enum EndWire {
    /// End of the motion.
    #[default]
    Interpolate,
    /// End frame, with extrapolation beyond it.
    Extrapolate,
}

impl EndWire {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
    pub(super) fn is_interpolate(&self) -> bool {
        *self == Self::Interpolate
    }
}

pub(super) fn blend<'de, D: Deserializer<'de>>(
    reader: D,
) -> Result<Option<PathBlendWire>, D::Error> {
    object_or_null_like(reader, r#"an object such as { "cart_mm": 30 }"#)
}

/// Zone about the target in which the path may cut the corner; the smallest given size applies.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "PathBlend", extend("minProperties" = 1))]
pub(super) struct PathBlendWire {
    /// Distance from the target, in mm; below 4 the robot stops.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    cart_mm: Option<f64>,
    /// Largest deviation of the orientation from the target's, in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    ori_deg: Option<f64>,
    /// Sunrise's `setBlendingRel`: on TCP paths it applies to the redundancy only, and the blend is
    /// as small as possible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 1))]
    sunrise_rel: Option<f64>,
}

impl PathBlendWire {
    pub(super) fn blend(self) -> PathBlend {
        PathBlend {
            cart_mm: self.cart_mm,
            orientation_rad: self.ori_deg.map(f64::to_radians),
            sunrise_rel: self.sunrise_rel,
            fraction: None,
        }
    }
}

impl From<PathBlend> for PathBlendWire {
    fn from(blend: PathBlend) -> Self {
        Self {
            cart_mm: blend.cart_mm,
            ori_deg: blend.orientation_rad.map(exact_deg),
            sunrise_rel: blend.sunrise_rel,
        }
    }
}
