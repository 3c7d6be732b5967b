//! JSON form of point-to-point motions.

use iiwa_json::{numbers, object_or_null_like};
use iiwa_kin::Joints;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, de::Error as _};

use super::{frames::TargetRefWire, limits::Share, notes::noted_wire};
use crate::{
    blend::Blend,
    cartesian_motion::{CartesianMotion, Course, PathBlend},
    limit_kind::ByKind,
    program::{Motion, Ptp},
    target::TargetRef,
};

#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(inline)]
enum PtpTag {
    #[serde(rename = "ptp")]
    Ptp,
}

noted_wire! {
/// A point-to-point motion, with its target as `joints_deg`, `joints_rad` or a `frame`.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    rename = "Ptp",
    extend("oneOf" = [
        {"required": ["joints_deg"]}, {"required": ["joints_rad"]}, {"required": ["frame"]}
    ])
)]
pub(super) struct PtpWire {
    r#type: PtpTag,
    /// Joints A1 to A7, in rad.
    #[serde(default, deserialize_with = "seven", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 7]")]
    joints_rad: Option<Joints>,
    /// Joints A1 to A7, in degrees.
    #[serde(default, deserialize_with = "seven", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 7]")]
    joints_deg: Option<Joints>,
    /// TCP frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    frame: Option<TargetRefWire>,
    /// TCP that moves to the frame, `TOOL` or `TOOL/TIP`; the program's by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tool: Option<String>,
    /// Base of the frame; the program's by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    base: Option<String>,
    /// Share of the speed limits, above 0 and at most 1: one for all joints or one per joint.
    #[serde(default, skip_serializing_if = "Share::is_full")]
    velocity_rel: Share,
    /// Share of the acceleration limits, above 0 and at most 1.
    #[serde(default, skip_serializing_if = "Share::is_full")]
    acceleration_rel: Share,
    /// Share of the jerk limits, above 0 and at most 1.
    #[serde(default, skip_serializing_if = "Share::is_full")]
    jerk_rel: Share,
    /// Blend at the target; without a blend the robot stops there.
    #[serde(default, deserialize_with = "blend", skip_serializing_if = "Option::is_none")]
    blend: Option<Blend>,
    /// `true` if the program waits for the end of the motion before it sends the next one, like
    /// Sunrise's `move`: a longer standstill follows. Not allowed together with a blend.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    blocking: bool,
}
}

fn blend<'de, D: Deserializer<'de>>(reader: D) -> Result<Option<Blend>, D::Error> {
    object_or_null_like(reader, r#"an object such as { "fraction": 0.25 } or { "cart_mm": 30 }"#)
}

/// Custom reader, because serde's error messages for enumerations do not tell the user what to
/// write.
impl<'de> Deserialize<'de> for Blend {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Sizes {
            #[serde(default, deserialize_with = "given")]
            fraction: Option<f64>,
            #[serde(default, deserialize_with = "given")]
            sunrise_rel: Option<f64>,
            #[serde(default, deserialize_with = "given")]
            cart_mm: Option<f64>,
        }
        /// Reads the value of a key that is present; null is an error.
        fn given<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
            f64::deserialize(deserializer).map(Some)
        }
        let sizes = Sizes::deserialize(deserializer)?;
        match (sizes.fraction, sizes.sunrise_rel, sizes.cart_mm) {
            (Some(b), None, None) => Ok(Self::Fraction(b)),
            (None, Some(x), None) => Ok(Self::SunriseRel(x)),
            (None, None, Some(r)) => Ok(Self::CartMm(r)),
            _ => Err(D::Error::custom(
                "a blend has exactly one of `fraction`, `sunrise_rel` and `cart_mm`",
            )),
        }
    }
}

impl PtpWire {
    pub(super) fn motion(self) -> Result<Motion, String> {
        let shares = [self.velocity_rel, self.acceleration_rel, self.jerk_rel].map(Share::each);
        if let Some(frame) = self.frame {
            if self.joints_rad.is_some() || self.joints_deg.is_some() {
                return Err("give either the joints or a `frame`, not both".to_owned());
            }
            return Ok(Motion::Cartesian(Box::new(CartesianMotion {
                tool: self.tool,
                base: self.base,
                shares: ByKind::from_array(shares),
                blend: self.blend.map(PathBlend::from),
                blocking: self.blocking,
                ..CartesianMotion::new(Course::Ptp { to: frame.target()? })
            })));
        }
        let [velocity_rel, acceleration_rel, jerk_rel] = shares;
        let target_rad = joints_of(self.joints_rad, self.joints_deg)?;
        Ok(Motion::Ptp(Ptp {
            target_rad,
            velocity_rel,
            acceleration_rel,
            jerk_rel,
            blend: self.blend,
            blocking: self.blocking,
        }))
    }

    pub(super) fn to_joints(ptp: &Ptp) -> Self {
        let shares = [ptp.velocity_rel, ptp.acceleration_rel, ptp.jerk_rel];
        Self {
            joints_rad: Some(ptp.target_rad),
            blocking: ptp.blocking,
            ..Self::to_nowhere(shares, ptp.blend)
        }
    }

    pub(super) fn to_frame(motion: &CartesianMotion, to: &TargetRef) -> Self {
        let blend = motion.blend.and_then(|blend| blend.in_joints());
        Self {
            frame: Some(to.into()),
            tool: motion.tool.clone(),
            base: motion.base.clone(),
            blocking: motion.blocking,
            ..Self::to_nowhere(motion.shares.into_array(), blend)
        }
    }

    /// A motion without a target.
    fn to_nowhere([velocity, acceleration, jerk]: [Joints; 3], blend: Option<Blend>) -> Self {
        Self {
            r#type: PtpTag::Ptp,
            joints_rad: None,
            joints_deg: None,
            frame: None,
            tool: None,
            base: None,
            velocity_rel: Share::from(velocity),
            acceleration_rel: Share::from(acceleration),
            jerk_rel: Share::from(jerk),
            name: None,
            comment: None,
            group: None,
            source: None,
            blocking: false,
            blend,
        }
    }
}

/// Joint positions in rad, from values in rad or in degrees.
pub(super) fn joints_of(rad: Option<Joints>, deg: Option<Joints>) -> Result<Joints, &'static str> {
    match (rad, deg) {
        (Some(rad), None) => Ok(rad),
        (None, Some(deg)) => Ok(deg.map(f64::to_radians)),
        (None, None) => Err("the target is missing: give `joints_deg`, `joints_rad` or `frame`"),
        (Some(_), Some(_)) => Err("give either `joints_deg` or `joints_rad`, not both"),
    }
}

pub(super) fn seven<'de, D: Deserializer<'de>>(reader: D) -> Result<Option<Joints>, D::Error> {
    numbers(reader, "seven joint angles, A1 to A7").map(Some)
}
