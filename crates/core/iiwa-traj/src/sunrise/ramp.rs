//! Acceleration ramp at one end of a line, from rest, by a [`RampLaw`](iiwa_kin::RampLaw).
//!
//! | phase | up to the speed | jerk |
//! |---|---|---|
//! | 1 | v1 | from 0 to J, linearly: constant snap |
//! | 2 | v2, at which J would reach the acceleration, if that is more than a width beyond v1 | constant, below J |
//! | 3 | a width beyond v1 or v2 | from the previous value, linearly, or constant where it would fall below 0 |
//!
//! A width is 0.3 rad/s in all measurements. The ramp from the acceleration down into the cruise is
//! the mirror image of this ramp.
//!
//! **Assumed**, since nothing was measured: where the speed is too low for a ramp and its mirror
//! image, both are shorter and lower, with the same snap; and where jerk would have to grow in
//! phase 3, that phase is as long as with constant jerk. Both cases are continuous with the
//! measured range.

use iiwa_kin::{RampEnd, RampLimits, vector};
use iiwa_path::{JointPath, Step};

use crate::{phases::ProfilePoint, section::Piece};

/// Phase of constant snap along a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RampPhase {
    /// Duration, in s.
    pub seconds: f64,
    /// Jerk at the start, in rad/s^3.
    pub jerk: f64,
    /// Snap, in rad/s^4.
    pub snap: f64,
}

/// End of the first phase, of constant snap, of a ramp from rest along a line in joint space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RampStart {
    /// Speed, in rad/s.
    pub speed: f64,
    /// Jerk, in rad/s^3.
    pub jerk: f64,
}

/// Ramp from zero acceleration to the largest acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ramp {
    /// Phases; unused ones have no duration.
    pub(crate) phases: [RampPhase; 3],
    pub(crate) seconds: f64,
    /// Acceleration at the end, in rad/s^2.
    pub(crate) acceleration: f64,
}

/// Share of phase 2 in the growth of the squared acceleration after phase 1; measured: 0.608 to
/// 0.610.
const CONSTANT_SHARE: f64 = 0.61;

/// Share of a limit that is rounding.
const ROUNDING: f64 = 1e-12;

impl RampPhase {
    /// Returns the state at the end of a phase, given the state at its start.
    pub(super) fn after(&self, from: &ProfilePoint) -> ProfilePoint {
        let Self { seconds: t, jerk, snap } = *self;
        let ProfilePoint { speed: v, acceleration: a, .. } = *from;
        ProfilePoint {
            t_s: from.t_s + t,
            way: from.way + t * (v + t * (a / 2.0 + t * (jerk / 6.0 + t * snap / 24.0))),
            speed: v + t * (a + t * (jerk / 2.0 + t * snap / 6.0)),
            acceleration: a + t * (jerk + t * snap / 2.0),
            ..ProfilePoint::default()
        }
    }
}

impl Ramp {
    /// Creates the ramp to an acceleration, in rad/s^2, with a width in rad/s.
    pub(crate) fn to(acceleration: f64, limits: &RampLimits, width: f64) -> Self {
        let phases = RampStart::by(limits, acceleration, width).phases(acceleration, width);
        Self { phases, seconds: phases.iter().map(|phase| phase.seconds).sum(), acceleration }
    }

    /// Returns the ramp to the acceleration, or as far towards it as a speed allows: the ramp and
    /// its mirror image stay below the speed.
    pub(crate) fn below(self, speed: f64) -> Self {
        let share = speed / (self.acceleration * self.seconds);
        if share >= 1.0 {
            return self;
        }
        // At equal snap, speed is proportional to the third power of time, acceleration to the
        // second.
        let root = share.cbrt();
        let faster = |RampPhase { seconds, jerk, snap }| RampPhase {
            seconds: root * seconds,
            jerk: root * jerk,
            snap,
        };
        Self {
            phases: self.phases.map(faster),
            seconds: root * self.seconds,
            acceleration: root * root * self.acceleration,
        }
    }

    /// Returns the extra time that the ramp takes to its speed, compared with its final
    /// acceleration from the start, in s.
    pub(crate) fn lost_s(&self) -> f64 {
        let rest = ProfilePoint::default();
        let end = self.phases.iter().fold(rest, |point, phase| phase.after(&point));
        self.seconds - end.speed / self.acceleration
    }
}

impl RampStart {
    /// Creates the start of a ramp to an acceleration, in rad/s^2, with a width in rad/s.
    #[must_use]
    pub fn by(limits: &RampLimits, acceleration: f64, width: f64) -> Self {
        let a = acceleration;
        let v1 = (2.0_f64.sqrt() / 3.0 * a.powf(1.5) / limits.snap.sqrt()).max(width);
        let ramp = Self::at(v1, limits, a);
        if ramp.speed > width && ramp.gain(a) >= width { Self::at(width, limits, a) } else { ramp }
    }

    /// Creates the end of a phase that leads to a speed.
    fn at(speed: f64, limits: &RampLimits, acceleration: f64) -> Self {
        // J + c sqrt(1.5 J v1) = Y is a quadratic equation in the square root of J.
        let b = limits.damping_per_s * (1.5 * speed).sqrt();
        let root = 2.0 * limits.jerk / (b + (b * b + 4.0 * limits.jerk).sqrt());
        // At most the jerk with which this phase alone leads to the acceleration.
        Self { speed, jerk: (root * root).min(acceleration * acceleration / (1.5 * speed)) }
    }

    /// Returns the acceleration at this point, in rad/s^2.
    #[must_use]
    pub fn acceleration(&self) -> f64 {
        (1.5 * self.jerk * self.speed).sqrt()
    }

    /// Returns the speed gain from here to an acceleration under constant jerk.
    fn gain(&self, acceleration: f64) -> f64 {
        let a1 = self.acceleration();
        (acceleration * acceleration - a1 * a1) / (2.0 * self.jerk)
    }

    /// Returns the phases of the ramp to an acceleration, in rad/s^2, with a width in rad/s; unused
    /// phases have no duration.
    #[must_use]
    pub fn phases(&self, acceleration: f64, width: f64) -> [RampPhase; 3] {
        let a = acceleration;
        let first = Self { jerk: self.jerk.min(a * a / (1.5 * self.speed)), ..*self };
        let (a1, jerk) = (first.acceleration(), first.jerk);
        let seconds = 3.0 * first.speed / a1;
        let mut phases = [RampPhase::default(); 3];
        phases[0] = RampPhase { seconds, jerk: 0.0, snap: jerk / seconds };
        if a1 < a * (1.0 - ROUNDING) {
            let (mut from, mut from_jerk, mut width) = (a1, jerk, width);
            let gain = first.gain(a);
            if gain >= width {
                let a2 = (a1 * a1 + CONSTANT_SHARE * (a * a - a1 * a1)).sqrt();
                from_jerk = (a2 * a2 - a1 * a1) / (2.0 * gain);
                phases[1] =
                    RampPhase { seconds: (a2 - a1) / from_jerk, jerk: from_jerk, snap: 0.0 };
                from = a2;
                width = width.max((a * a - a2 * a2) / (2.0 * from_jerk));
            }
            phases[2] = last_phase(from, from_jerk, a, width);
        }
        phases
    }
}

/// Returns the phase that gains `width` of speed and ends with the acceleration `to`.
fn last_phase(from: f64, jerk: f64, to: f64, width: f64) -> RampPhase {
    // Speed gain in t with linearly changing jerk: t (2 from + to) / 3 + t^2 jerk / 6.
    let mean = (2.0 * from + to) / 3.0;
    let seconds = 2.0 * width / (mean + (mean * mean + 2.0 / 3.0 * jerk * width).sqrt());
    let snap = 2.0 * (to - from - jerk * seconds) / (seconds * seconds);
    if jerk + snap * seconds >= 0.0 {
        return RampPhase { seconds, jerk, snap };
    }
    let seconds = 2.0 * width / (from + to);
    RampPhase { seconds, jerk: (to - from) / seconds, snap: 0.0 }
}

/// Returns the limits of the ramp at one end of `pieces`, which run from rest to rest. None if they
/// do not move.
///
/// Two assumptions, since no recording has a payload or a reduced jerk limit: the payload counts as
/// part of the arm, and a share of the jerk limits is the same share of the snap limits.
pub(crate) fn ramp_limits(path: &JointPath, pieces: &[Piece], end: RampEnd) -> Option<RampLimits> {
    let (piece, s, sign) = match end {
        RampEnd::Start => (pieces.first()?, 0.0, 1.0),
        RampEnd::Stop => (pieces.last()?, 1.0, -1.0),
    };
    let Step::Move { segment, .. } = &path.steps()[piece.step] else { return None };
    let [direction, ..] = segment.sigma_derivatives(s);
    let rate = vector::norm(&direction);
    let away = direction.map(|d| sign * d / rate);
    let dynamics = path.dynamics(piece.motion);
    let torques = dynamics.path_torques(&segment.at(s).q, &away, &[0.0; 7]).acceleration;
    let shares = path.limits_of(piece.step).jerk_shares(&path.full_limits());
    Some(path.ramp_law().limits(&away, &torques, &shares, end))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Generates limits within and far beyond those of the robot.
    pub(in crate::sunrise) fn limits() -> impl Strategy<Value = RampLimits> {
        let log = |from: f64, to: f64| (from.ln()..to.ln()).prop_map(f64::exp);
        (log(1e2, 1e6), log(50.0, 1e5), 0.0..40.0_f64)
            .prop_map(|(snap, jerk, damping_per_s)| RampLimits { snap, jerk, damping_per_s })
    }

    /// Returns speed and acceleration after a ramp, and its largest jerk.
    fn run(ramp: &Ramp) -> [f64; 3] {
        let (mut v, mut a, mut max_jerk) = (0.0, 0.0, 0.0_f64);
        for RampPhase { seconds: t, jerk, snap } in ramp.phases {
            v += t * (a + t * (jerk / 2.0 + t * snap / 6.0));
            a += t * (jerk + t * snap / 2.0);
            max_jerk = max_jerk.max(jerk).max(jerk + t * snap);
        }
        [v, a, max_jerk]
    }

    proptest! {
        #[test]
        fn it_ends_with_its_acceleration_and_keeps_its_limits(
            limits in limits(), acceleration in 0.1..100.0_f64, width in 0.01..0.5_f64,
        ) {
            let ramp = Ramp::to(acceleration, &limits, width);
            let [v, a, jerk] = run(&ramp);
            prop_assert!((a / acceleration - 1.0).abs() < 1e-9, "{ramp:?}");
            prop_assert!(v >= width * (1.0 - 1e-9));
            prop_assert!(jerk <= limits.jerk * (1.0 + 1e-9));
            prop_assert!(
                ramp.phases[0].snap <= limits.snap * (1.0 + 1e-9)
                    || ramp.phases[0].snap * 1.5 * width * width * width <= jerk * jerk * jerk
            );
            prop_assert!(ramp.phases.iter().all(|it| it.seconds >= 0.0 && it.jerk >= 0.0));
        }

        /// Both ramps together stay below any speed and exceed no quantity of the whole ramp, and
        /// small changes have small effects.
        #[test]
        fn it_fits_below_any_speed(
            limits in limits(),
            acceleration in 0.1..100.0_f64,
            speed in 1e-4..4.0_f64,
        ) {
            let whole = Ramp::to(acceleration, &limits, 0.3);
            let ramp = whole.below(speed);
            let [v, a, jerk] = run(&ramp);
            prop_assert!((a / ramp.acceleration - 1.0).abs() < 1e-9 && v <= speed);
            prop_assert!(a * ramp.seconds <= speed * (1.0 + 1e-9));
            prop_assert!(jerk <= run(&whole)[2] * (1.0 + 1e-9));
            let more = whole.below(speed * (1.0 + 1e-6));
            prop_assert!(
                (more.seconds / ramp.seconds - 1.0).abs() < 1e-6 && more.seconds >= ramp.seconds
            );
            prop_assert!(ramp.lost_s() > 0.0 && ramp.lost_s() < ramp.seconds);
        }
    }

    /// A ramp whose constant jerk does not reach the acceleration within a width has three phases.
    #[test]
    fn a_weak_jerk_has_three_phases() {
        for (jerk, is_measured) in [(300.0, true), (200.0, false)] {
            let limits = RampLimits { snap: 1e5, jerk, damping_per_s: 0.0 };
            let ramp = Ramp::to(19.0, &limits, 0.3);
            let [v, a, max_jerk] = run(&ramp);
            assert!(ramp.phases.iter().all(|phase| phase.seconds > 0.0), "{ramp:?}");
            let a1 = (1.5 * jerk * 0.3).sqrt();
            let gain = (19.0 * 19.0 - a1 * a1) / (2.0 * jerk);
            let last = if is_measured { 0.3 } else { 0.39 / 0.61 * gain };
            assert!(last >= 0.3 && (v - (0.3 + gain + last)).abs() < 1e-9, "{v} {gain}");
            assert!((a - 19.0).abs() < 1e-9 && max_jerk <= jerk * (1.0 + 1e-9));
        }
    }
}
