//! Limit keys of motions: shares of the joint limits, and limits of TCP paths and spline segments.

use std::fmt;

use iiwa_json::Numbers;
use iiwa_kin::Joints;
use schemars::JsonSchema;
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{SeqAccess, Visitor},
};

use crate::{cartesian_motion::SegmentLimits, limit_kind::ByKind, tool_limits::ToolLimits};

/// One share for all joints, or one per joint.
#[derive(Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub(super) enum Share {
    All(#[schemars(extend("minimum" = 1e-6, "maximum" = 1))] f64),
    Each(
        #[schemars(extend(
            "items" = { "type": "number", "minimum": 1e-6, "maximum": 1 }
        ))]
        Joints,
    ),
}

impl Default for Share {
    fn default() -> Self {
        Self::All(1.0)
    }
}

impl Share {
    pub(super) fn is_full(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn each(self) -> Joints {
        match self {
            Self::All(share) => [share; 7],
            Self::Each(shares) => shares,
        }
    }
}

impl From<Joints> for Share {
    fn from(shares: Joints) -> Self {
        if shares.iter().all(|share| *share == shares[0]) {
            Self::All(shares[0])
        } else {
            Self::Each(shares)
        }
    }
}

impl<'de> Deserialize<'de> for Share {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ShareVisitor;
        impl<'de> Visitor<'de> for ShareVisitor {
            type Value = Share;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number above 0 and at most 1, or seven of them")
            }
            fn visit_f64<E>(self, value: f64) -> Result<Share, E> {
                Ok(Share::All(value))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Share, E> {
                Ok(Share::All(value as f64))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Share, E> {
                Ok(Share::All(value as f64))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Share, A::Error> {
                Numbers("seven shares, for joints A1 to A7").visit_seq(seq).map(Share::Each)
            }
        }
        deserializer.deserialize_any(ShareVisitor)
    }
}

/// Declares a type with the limit keys between its other keys.
/// `declared by MACRO` selects the macro that declares the type.
macro_rules! limited_wire {
    (
        $(#[$meta:meta])* $name:ident declared by $declare:ident
        { $($(#[$before_meta:meta])* $before:ident: $before_type:ty,)* }
        { $($(#[$after_meta:meta])* $after:ident: $after_type:ty,)* }
    ) => {
        $crate::wire::notes::$declare! {
        #[derive(Default, Deserialize, Serialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        $(#[$meta])*
        pub(super) struct $name {
            $($(#[$before_meta])* $before: $before_type,)*
            /// Share of the joint speed limits, above 0 and at most 1.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            velocity_rel: Option<$crate::wire::limits::Share>,
            /// Share of the joint acceleration limits, above 0 and at most 1.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            acceleration_rel: Option<$crate::wire::limits::Share>,
            /// Share of the joint jerk limits, above 0 and at most 1.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            jerk_rel: Option<$crate::wire::limits::Share>,
            /// TCP speed limit, in mm/s.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("minimum" = 0.001))]
            cart_velocity_mm_s: Option<f64>,
            /// TCP acceleration limit along the path, in mm/s^2.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("minimum" = 1))]
            cart_acceleration_mm_s2: Option<f64>,
            /// TCP jerk limit along the path, in mm/s^3.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("minimum" = 0.001))]
            cart_jerk_mm_s3: Option<f64>,
            /// Angular speed limit of the TCP, in deg/s.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("minimum" = 0.001))]
            orientation_velocity_deg_s: Option<f64>,
            /// Angular acceleration limit of the TCP, in deg/s^2.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("minimum" = 0.1))]
            orientation_acceleration_deg_s2: Option<f64>,
            /// Angular jerk limit of the TCP, in deg/s^3.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("minimum" = 0.001))]
            orientation_jerk_deg_s3: Option<f64>,
            $($(#[$after_meta])* $after: $after_type,)*
        }
        }

        impl $name {
            /// Limits that are given.
            fn limits(&self) -> $crate::cartesian_motion::SegmentLimits {
                $crate::wire::limits::given_limits(
                    [self.velocity_rel, self.acceleration_rel, self.jerk_rel],
                    [
                        self.cart_velocity_mm_s,
                        self.cart_acceleration_mm_s2,
                        self.cart_jerk_mm_s3,
                    ],
                    [
                        self.orientation_velocity_deg_s,
                        self.orientation_acceleration_deg_s2,
                        self.orientation_jerk_deg_s3,
                    ],
                )
            }

            /// Replaces the limits.
            fn with_limits(self, limits: &$crate::cartesian_motion::SegmentLimits) -> Self {
                use $crate::wire::{
                    exact::{exact_deg, exact_mm},
                    limits::{Share, written_limits},
                };
                let shares = limits.shares.into_array().map(|share| share.map(Share::from));
                let [velocity_rel, acceleration_rel, jerk_rel] = shares;
                let [velocity_mm, acceleration_mm, jerk_mm] =
                    written_limits(&limits.tool.way, exact_mm);
                let [velocity_deg, acceleration_deg, jerk_deg] =
                    written_limits(&limits.tool.turn, exact_deg);
                Self {
                    velocity_rel,
                    acceleration_rel,
                    jerk_rel,
                    cart_velocity_mm_s: velocity_mm,
                    cart_acceleration_mm_s2: acceleration_mm,
                    cart_jerk_mm_s3: jerk_mm,
                    orientation_velocity_deg_s: velocity_deg,
                    orientation_acceleration_deg_s2: acceleration_deg,
                    orientation_jerk_deg_s3: jerk_deg,
                    ..self
                }
            }
        }
    };
}

pub(super) use limited_wire;

/// Limits given by the values of their keys, for velocity, acceleration and jerk: shares of the
/// joint limits, path limits in mm and orientation limits in degrees, over s to the power of the
/// kind's order.
pub(super) fn given_limits(
    shares: [Option<Share>; 3],
    way_mm: [Option<f64>; 3],
    turn_deg: [Option<f64>; 3],
) -> SegmentLimits {
    let in_si = |limits: [Option<f64>; 3], unit: fn(f64) -> f64| {
        ByKind::from_array(limits.map(|limit| limit.map_or(f64::INFINITY, unit)))
    };
    SegmentLimits {
        shares: ByKind::from_array(shares.map(|share| share.map(Share::each))),
        tool: ToolLimits {
            way: in_si(way_mm, |limit| 1e-3 * limit),
            turn: in_si(turn_deg, f64::to_radians),
        },
    }
}

/// Values of the keys of TCP limits in their `unit`; `None` where unlimited.
pub(super) fn written_limits(limits: &ByKind<f64>, unit: fn(f64) -> f64) -> [Option<f64>; 3] {
    limits.into_array().map(|limit| limit.is_finite().then(|| unit(limit)))
}
