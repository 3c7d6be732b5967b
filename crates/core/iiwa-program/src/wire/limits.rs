//! Limit keys of TCP paths and spline segments.

use super::{
    exact::{exact_deg, exact_mm},
    share::Share,
};
use crate::{limit_kind::ByKind, segment_limits::SegmentLimits, tool_limits::ToolLimits};

/// Declares a type with the limit keys between its other keys.
macro_rules! limited_wire {
    (
        $(#[$meta:meta])* $name:ident
        { $($(#[$before_meta:meta])* $before:ident: $before_type:ty,)* }
        { $($(#[$after_meta:meta])* $after:ident: $after_type:ty,)* }
    ) => {
        #[derive(Default, Deserialize, Serialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        $(#[$meta])*
        pub(super) struct $name {
            $($(#[$before_meta])* $before: $before_type,)*
            /// Share of the joint speed limits, above 0 and at most 1.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            velocity_rel: Option<$crate::wire::share::Share>,
            /// Share of the joint acceleration limits, above 0 and at most 1.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            acceleration_rel: Option<$crate::wire::share::Share>,
            /// Share of the joint jerk limits, above 0 and at most 1.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            jerk_rel: Option<$crate::wire::share::Share>,
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

        impl $name {
            /// Limits that are given.
            fn limits(&self) -> $crate::segment_limits::SegmentLimits {
                let values = $crate::wire::limits::LimitValues {
                    shares: [self.velocity_rel, self.acceleration_rel, self.jerk_rel],
                    way_mm: [
                        self.cart_velocity_mm_s,
                        self.cart_acceleration_mm_s2,
                        self.cart_jerk_mm_s3,
                    ],
                    turn_deg: [
                        self.orientation_velocity_deg_s,
                        self.orientation_acceleration_deg_s2,
                        self.orientation_jerk_deg_s3,
                    ],
                };
                values.into()
            }

            /// Replaces the limits.
            fn with_limits(self, limits: &$crate::segment_limits::SegmentLimits) -> Self {
                let values = $crate::wire::limits::LimitValues::from(limits);
                let [velocity_rel, acceleration_rel, jerk_rel] = values.shares;
                let [velocity_mm, acceleration_mm, jerk_mm] = values.way_mm;
                let [velocity_deg, acceleration_deg, jerk_deg] = values.turn_deg;
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

/// Values of the limit keys, for velocity, acceleration and jerk.
pub(super) struct LimitValues {
    pub(super) shares: [Option<Share>; 3],
    /// Path limits, in mm over s to the power of the kind's order.
    pub(super) way_mm: [Option<f64>; 3],
    /// Orientation limits, in degrees over s to the same power.
    pub(super) turn_deg: [Option<f64>; 3],
}

impl From<LimitValues> for SegmentLimits {
    fn from(values: LimitValues) -> Self {
        let or_unlimited =
            |limit: Option<f64>, unit: fn(f64) -> f64| limit.map_or(f64::INFINITY, unit);
        let LimitValues { shares, way_mm, turn_deg } = values;
        Self {
            shares: ByKind::from_array(shares.map(|share| share.map(Share::each))),
            tool: ToolLimits {
                way: ByKind::from_array(
                    way_mm.map(|limit| or_unlimited(limit, |limit| 1e-3 * limit)),
                ),
                turn: ByKind::from_array(
                    turn_deg.map(|limit| or_unlimited(limit, f64::to_radians)),
                ),
            },
        }
    }
}

impl From<&SegmentLimits> for LimitValues {
    fn from(SegmentLimits { shares, tool }: &SegmentLimits) -> Self {
        let if_limited = |limit: f64, unit: fn(f64) -> f64| limit.is_finite().then(|| unit(limit));
        Self {
            shares: shares.into_array().map(|share| share.map(Share::from)),
            way_mm: tool.way.into_array().map(|limit| if_limited(limit, exact_mm)),
            turn_deg: tool.turn.into_array().map(|limit| if_limited(limit, exact_deg)),
        }
    }
}
