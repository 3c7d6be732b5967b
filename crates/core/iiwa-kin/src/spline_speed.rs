//! Speed along splines under Sunrise.

/// Model of the speed v of the TCP along a spline from rest to rest. **A model, not a law**: it predicts recorded durations within
/// 3 %; docs/evidence.md has the errors.
///
/// With the joints q as a function of the TCP's way, V and A the joint limits, D the length from rest to rest:
///
/// | limit | where |
/// |---|---|
/// | `v <= V_i / abs(q'_i)` of each joint | everywhere: measured within 1 % |
/// | `v <= D / least_cruise_s` | everywhere: measured within 0.01 % ([`RampLaw`](crate::RampLaw)) |
/// | `v <= sqrt(bend_rel A_i / abs(q''_i))` of each joint | everywhere |
/// | the least v of these that is allowed within `hold_s / 2` before or behind | everywhere |
/// | `abs(dv/dt) <= a`, `abs(d2v/dt2) <= a / T`, where `a = min_i A_i / abs(q'_i)` and T is the time of the ramp of a PTP motion | next to rest |
/// | `abs(dv/dt) <= tangent_rel a`, `abs(d2v/dt2) <= a / build_up_s` | elsewhere |
///
/// So joint accelerations exceed A in bends, as those of the recorded robot do: by a factor of 4 to 6.8.
///
/// Source: 20 different splines of one LBR iiwa 7 R800 in 2021, and 6 lines of 28 to 85 mm in 2021, from the recordings of
/// [`RampLaw`](crate::RampLaw).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SplineSpeed {
    /// Largest joint acceleration by the curvature of the path, as a multiple of the acceleration limit.
    pub bend_rel: f64,
    /// Largest acceleration along the path, as a share of what the joints' acceleration limits allow.
    pub tangent_rel: f64,
    /// Time in which jerk builds up the acceleration limit, in s.
    pub build_up_s: f64,
    /// Time for which a least speed along the way is held around its place, in s.
    pub hold_s: f64,
    /// Reach of the ramp of a start or a stop, as a share of the way on which a limit of speed is reached without limits of jerk.
    /// From there to twice as far, the limits go over into the others.
    pub ramp_reach: f64,
    /// Time of the ramps of short motions, in s. Where the whole way over `least_cruise_s` is 0.55 times `least_cruise_s` times the
    /// acceleration or less; from there to once that product, the time goes over into that of PTP ramps.
    pub short_ramp_s: f64,
}

impl SplineSpeed {
    /// The figures of the LBR iiwa 7.
    pub(crate) const IIWA_7: Self = Self {
        bend_rel: 4.6,
        tangent_rel: 0.78,
        build_up_s: 0.19,
        hold_s: 0.03,
        ramp_reach: 0.7,
        short_ramp_s: 0.09,
    };

    /// The model at an override: the time of a motion, divided by `share`.
    pub(crate) fn slowed_down(self, share: f64) -> Self {
        Self {
            build_up_s: self.build_up_s / share,
            hold_s: self.hold_s / share,
            short_ramp_s: self.short_ramp_s / share,
            ..self
        }
    }
}
