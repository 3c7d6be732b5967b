//! Ramps of PTP motions in profiles.

use iiwa_json::{
    JsonStep::{Index, Key},
    numbers,
};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use super::{
    bounds::{MAX_NUMBER, RAMPS},
    error::ProfileError,
    units::{SAME, checked},
};
use crate::{Joints, RampLaw, Robot, SplineSpeed};

/// Limits of PTP ramps and spline speeds; the built-in model's by default (law: docs/evidence.md).
#[derive(Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Ramps")]
pub(super) struct RampsWire {
    /// Limits of the second time derivative of the torques of joints A1 to A7, in Nm/s^2: S.
    #[serde(default, deserialize_with = "seven", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 7), extend("items" = super::positive(MAX_NUMBER)))]
    torque_snap_nm_s2: Option<Joints>,
    /// Inertia of joints A1 to A7 in addition to the arm, such as motor inertia, in kg m^2: B.
    #[serde(default, deserialize_with = "seven", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 7), extend("items" = super::positive(MAX_NUMBER)))]
    motor_inertia_kg_m2: Option<Joints>,
    /// Jerk limits of joints A1 to A7 at the start, in Nm/s: R. 1e9 for joints that were never seen
    /// to limit the jerk.
    #[serde(default, deserialize_with = "seven", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 7), extend("items" = super::positive(MAX_NUMBER)))]
    start_nm_s: Option<Joints>,
    /// Jerk limits of joints A1 to A7 at the end, in Nm/s.
    #[serde(default, deserialize_with = "seven", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<f64>", length(equal = 7), extend("items" = super::positive(MAX_NUMBER)))]
    stop_nm_s: Option<Joints>,
    /// Jerk reduction per acceleration, in 1/s: c.
    #[serde(default, deserialize_with = "super::given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_NUMBER))]
    damping_per_s: Option<f64>,
    /// Width of a ramp phase, in rad/s along the line.
    #[serde(default, deserialize_with = "super::given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_NUMBER))]
    width_rad_s: Option<f64>,
    /// Lower bound of the length of a line or a spline divided by its top speed, in s.
    #[serde(default, deserialize_with = "super::given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_NUMBER))]
    least_cruise_s: Option<f64>,
    /// Spline speed model: limit of the joint acceleration due to path curvature, as a multiple of
    /// the acceleration limit.
    #[serde(default, deserialize_with = "super::given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_NUMBER))]
    spline_bend_rel: Option<f64>,
    /// Spline speed model: limit of the acceleration along the path, as a share of the acceleration
    /// that the joint limits allow.
    #[serde(default, deserialize_with = "super::given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_NUMBER))]
    spline_tangent_rel: Option<f64>,
    /// Spline speed model: time in which the jerk limit builds up the acceleration limit, in s.
    #[serde(default, deserialize_with = "super::given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_NUMBER))]
    spline_build_up_s: Option<f64>,
    /// Spline speed model: time for which a local minimum of the speed is held, in s.
    #[serde(default, deserialize_with = "super::given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_NUMBER))]
    spline_hold_s: Option<f64>,
    /// Spline speed model: reach of the ramps at start and stop, as a share of the distance to the
    /// first speed limit.
    #[serde(default, deserialize_with = "super::given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_NUMBER))]
    spline_ramp_reach: Option<f64>,
    /// Spline speed model: ramp time of short motions, in s.
    #[serde(default, deserialize_with = "super::given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("exclusiveMinimum" = 0, "maximum" = MAX_NUMBER))]
    spline_short_ramp_s: Option<f64>,
}

fn seven<'de, D: Deserializer<'de>>(reader: D) -> Result<Option<Joints>, D::Error> {
    numbers(reader, "seven numbers, for joints A1 to A7").map(Some)
}

impl RampsWire {
    /// The law `base` with the given values replaced.
    pub(super) fn law(&self, text: &str, base: &RampLaw) -> Result<RampLaw, ProfileError> {
        let mut law = *base;
        for (key, values, field) in [
            ("torque_snap_nm_s2", self.torque_snap_nm_s2, &mut law.torque_snap_nm_s2),
            ("motor_inertia_kg_m2", self.motor_inertia_kg_m2, &mut law.motor_inertia_kg_m2),
            ("start_nm_s", self.start_nm_s, &mut law.start_nm_s),
            ("stop_nm_s", self.stop_nm_s, &mut law.stop_nm_s),
        ] {
            let Some(values) = values else { continue };
            for (index, value) in values.into_iter().enumerate() {
                let quantity = || format!("{RAMPS}: {key} of joint A{}", index + 1);
                let place = [Key(RAMPS), Key(key), Index(index)];
                field[index] = checked(text, &place, value, MAX_NUMBER, quantity, SAME)?;
            }
        }
        for (key, values, field) in [
            ("damping_per_s", self.damping_per_s, &mut law.damping_per_s),
            ("width_rad_s", self.width_rad_s, &mut law.width_rad_s),
            ("least_cruise_s", self.least_cruise_s, &mut law.least_cruise_s),
            ("spline_bend_rel", self.spline_bend_rel, &mut law.spline.bend_rel),
            ("spline_tangent_rel", self.spline_tangent_rel, &mut law.spline.tangent_rel),
            ("spline_build_up_s", self.spline_build_up_s, &mut law.spline.build_up_s),
            ("spline_hold_s", self.spline_hold_s, &mut law.spline.hold_s),
            ("spline_ramp_reach", self.spline_ramp_reach, &mut law.spline.ramp_reach),
            ("spline_short_ramp_s", self.spline_short_ramp_s, &mut law.spline.short_ramp_s),
        ] {
            let Some(value) = values else { continue };
            let quantity = || format!("{RAMPS}: {key}");
            *field = checked(text, &[Key(RAMPS), Key(key)], value, MAX_NUMBER, quantity, SAME)?;
        }
        Ok(law)
    }

    /// All values of the law, if the law differs from that of `base` or is an assumption only in
    /// `base`.
    pub(super) fn of(
        robot: &Robot,
        base: &Robot,
        differ: fn(&[f64], &[f64]) -> bool,
    ) -> Option<Self> {
        let numbers = |law: &RampLaw| {
            let RampLaw { damping_per_s, width_rad_s, least_cruise_s, spline, .. } = *law;
            let SplineSpeed {
                // All fields, so that a new field has to be compared as well.
                bend_rel,
                tangent_rel,
                build_up_s,
                hold_s,
                ramp_reach,
                short_ramp_s,
            } = spline;
            let lists =
                [law.torque_snap_nm_s2, law.motor_inertia_kg_m2, law.start_nm_s, law.stop_nm_s];
            let spline = [bend_rel, tangent_rel, build_up_s, hold_s, ramp_reach, short_ramp_s];
            [lists.as_flattened(), &[damping_per_s, width_rad_s, least_cruise_s], &spline].concat()
        };
        let becomes_known = base.assumes("ramps") && !robot.assumes("ramps");
        let law = &robot.ramp_law;
        (becomes_known || differ(&numbers(law), &numbers(&base.ramp_law))).then_some(Self {
            torque_snap_nm_s2: Some(law.torque_snap_nm_s2),
            motor_inertia_kg_m2: Some(law.motor_inertia_kg_m2),
            start_nm_s: Some(law.start_nm_s),
            stop_nm_s: Some(law.stop_nm_s),
            damping_per_s: Some(law.damping_per_s),
            width_rad_s: Some(law.width_rad_s),
            least_cruise_s: Some(law.least_cruise_s),
            spline_bend_rel: Some(law.spline.bend_rel),
            spline_tangent_rel: Some(law.spline.tangent_rel),
            spline_build_up_s: Some(law.spline.build_up_s),
            spline_hold_s: Some(law.spline.hold_s),
            spline_ramp_reach: Some(law.spline.ramp_reach),
            spline_short_ramp_s: Some(law.spline.short_ramp_s),
        })
    }
}
