//! Speed along splines under Sunrise.

/// Model of the TCP speed v along a spline from rest to rest. **A model, not a law**: it matches
/// recorded durations within 2 % (2.7 % for splines left out of the fit); docs/evidence.md has the
/// errors.
///
/// With the joints q as a function of the TCP path length, V and A the joint limits, D the length
/// from rest to rest:
///
/// | limit | where |
/// |---|---|
/// | `v <= V_i / abs(q'_i)` of each joint | everywhere: measured within 1 % |
/// | `v <= D / least_cruise_s` | everywhere: measured within 0.01 % ([`RampLaw`](crate::RampLaw)) |
/// | `v <= sqrt(bend_rel A_i / abs(q''_i))` of each joint | everywhere |
/// | the smallest v that these allow within `hold_s / 2` before or after | everywhere |
/// | `abs(dv/dt) <= a`, `abs(d2v/dt2) <= a / T`, where `a = min_i A_i / abs(q'_i)` and T is the time of the ramp of a PTP motion | next to rest |
/// | `abs(dv/dt) <= tangent_rel a`, `abs(d2v/dt2) <= a / build_up_s` | elsewhere |
///
/// Joint accelerations therefore exceed A in bends, as on the recorded robot: by a factor of 4 to
/// 6.8.
///
/// Source: 20 different splines of one LBR iiwa 7 R800 in 2021, and 6 lines of 28 to 85 mm in 2021,
/// from the recordings of [`RampLaw`](crate::RampLaw).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SplineSpeed {
    /// Limit of the joint acceleration due to path curvature, as a multiple of the acceleration
    /// limit.
    pub bend_rel: f64,
    /// Limit of the acceleration along the path, as a share of the acceleration that the joint
    /// limits allow.
    pub tangent_rel: f64,
    /// Time in which the jerk limit builds up the acceleration limit, in s.
    pub build_up_s: f64,
    /// Time for which a local minimum of the speed is held around its place, in s.
    pub hold_s: f64,
    /// Reach of a start or stop ramp, as a share of the distance on which a speed limit is reached
    /// without jerk limits. From there to twice that distance, the limits blend into the others.
    pub ramp_reach: f64,
    /// Ramp time of short motions, in s. It applies if the whole length over `least_cruise_s` is at
    /// most 0.55 times `least_cruise_s` times the acceleration; from there to once that product,
    /// the time blends into that of PTP ramps.
    pub short_ramp_s: f64,
}

impl SplineSpeed {
    /// Parameters of the LBR iiwa 7.
    pub(crate) const IIWA_7: Self = Self {
        bend_rel: 4.6,
        tangent_rel: 0.78,
        build_up_s: 0.19,
        hold_s: 0.03,
        ramp_reach: 0.7,
        short_ramp_s: 0.09,
    };

    /// Model at an override of `share`: the duration of a motion is divided by `share`.
    pub(crate) fn slowed_down(self, share: f64) -> Self {
        Self {
            build_up_s: self.build_up_s / share,
            hold_s: self.hold_s / share,
            short_ramp_s: self.short_ramp_s / share,
            ..self
        }
    }
}
