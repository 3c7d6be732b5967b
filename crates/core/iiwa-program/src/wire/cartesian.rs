//! JSON form of TCP paths.

use iiwa_json::{object, object_or_null_like};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use super::{
    by_name::word,
    exact::exact_deg,
    frames::{AuxRefWire, PoseWire, TCP, TargetRefWire},
    limits::limited_wire,
};
use crate::{
    cartesian_motion::{
        AuxOrientation, CartesianMotion, Circ, Course, OrientationType, PathBlend, SegmentLimits,
    },
    program::Motion,
    target::{Frame, TargetRef},
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
            $name declared by noted_wire {
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
                    skip_serializing_if = "is_default"
                )]
                orientation: OrientationType,
            } {
                /// Blend at the target; without a blend the robot stops there.
                #[serde(
                    default,
                    deserialize_with = "crate::wire::cartesian::blend",
                    skip_serializing_if = "Option::is_none"
                )]
                blend: Option<PathBlendWire>,
                /// `true` if the program waits for the end of the motion before it sends the next
                /// one, like Sunrise's `move`: a longer standstill follows. Not allowed together
                /// with a blend.
                #[serde(default, skip_serializing_if = "std::ops::Not::not")]
                blocking: bool,
            }
        }

        impl $name {
            /// Converts to a motion on `course`.
            fn on(self, course: Course) -> Motion {
                let limits = self.limits();
                Motion::Cartesian(Box::new(CartesianMotion {
                    course,
                    tool: self.tool,
                    base: self.base,
                    shares: limits.shares.map(|_, share| share.unwrap_or([1.0; 7])),
                    tool_limits: limits.tool,
                    orientation: self.orientation,
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
                    orientation: motion.orientation,
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
        /// Frame in whose orientation the offset is given: `tcp`, a frame, or the name of a base.
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
        aux: AuxRefWire,
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
        #[serde(default, deserialize_with = "word", skip_serializing_if = "is_default")]
        aux_orientation: AuxOrientation,
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
        let aux = std::mem::take(&mut self.aux);
        let to = std::mem::take(&mut self.frame).target();
        let options = CircOptions {
            angle_deg: self.circ_angle_deg,
            reference: self.orientation_reference,
            aux: self.aux_orientation,
            end: self.end_orientation,
        };
        let circ = options.circ(aux, to.map_err(|message| ("frame", message)));
        Ok(self.on(Course::Circ(circ?)))
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
    pub(super) aux: AuxOrientation,
    pub(super) end: EndWire,
}

impl CircOptions {
    /// Builds the circle. The orientation of an auxiliary position without one is ignored.
    pub(super) fn circ(
        mut self,
        aux: AuxRefWire,
        to: Result<TargetRef, Wrong>,
    ) -> Result<Circ, Wrong> {
        let (aux, has_orientation) = aux.target().map_err(|message| ("aux", message))?;
        if !has_orientation {
            if self.aux == AuxOrientation::Interpolate {
                let message = "`aux_orientation` is `interpolate`, which needs `a_deg`, `b_deg` \
                               and `c_deg`";
                return Err(("aux", message.to_owned()));
            }
            self.aux = AuxOrientation::Ignore;
        }
        Ok(Circ {
            aux,
            to: to?,
            angle_rad: self.angle_deg.map(f64::to_radians),
            turns_with_path: !self.reference.is_base(),
            aux_orientation: self.aux,
            extrapolates: !self.end.is_interpolate(),
        })
    }
}

impl From<&Circ> for CircOptions {
    fn from(circ: &Circ) -> Self {
        Self {
            angle_deg: circ.angle_rad.map(exact_deg),
            reference: if circ.turns_with_path { ReferenceWire::Path } else { ReferenceWire::Base },
            aux: circ.aux_orientation,
            end: if circ.extrapolates { EndWire::Extrapolate } else { EndWire::Interpolate },
        }
    }
}

/// Returns true for the default of a key, which is not written.
pub(super) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
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
