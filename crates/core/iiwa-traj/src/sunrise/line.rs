//! Motion from rest to rest along a line in joint space, as planned by Sunrise: acceleration ramps,
//! plateau, cruise.

use iiwa_kin::{RampLaw, RampLimits};

use super::ramp::{Ramp, RampPhase};
use crate::phases::ProfilePoint;

/// Limits of a line, in rad along the line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RampedLine<'a> {
    /// Largest speed, in rad/s.
    pub(crate) speed: f64,
    /// Largest acceleration, in rad/s^2.
    pub(crate) acceleration: f64,
    /// Ramp limits at the start and at the end.
    pub(crate) ends: [RampLimits; 2],
    pub(crate) law: &'a RampLaw,
}

/// Motion between rest and a speed: ramp, plateau, and the mirror image of the ramp.
struct Half {
    /// Ramp to the largest acceleration; lower speeds shorten it.
    ramp: Ramp,
    lost_s: f64,
}

impl Half {
    fn new(limits: &RampedLine<'_>, end: usize) -> Self {
        let ramp = Ramp::to(limits.acceleration, &limits.ends[end], limits.law.width_rad_s);
        Self { lost_s: ramp.lost_s(), ramp }
    }

    /// Returns the way to a speed, and its derivative.
    fn way(&self, speed: f64) -> [f64; 2] {
        let Self { ramp: Ramp { acceleration, seconds, .. }, lost_s } = *self;
        let min_speed = acceleration * seconds;
        if speed >= min_speed {
            let steady = speed / acceleration;
            let later = seconds - lost_s;
            return [speed * (0.5 * steady + later), steady + later];
        }
        let time = (speed / min_speed).cbrt() * (1.5 * seconds - lost_s);
        [speed * time, 4.0 / 3.0 * time]
    }

    /// Returns the phases to a speed.
    fn phases(&self, speed: f64) -> [RampPhase; 7] {
        let ramp = self.ramp.below(speed);
        let mut phases = [RampPhase::default(); 7];
        phases[..3].copy_from_slice(&ramp.phases);
        phases[3].seconds = (speed / ramp.acceleration - ramp.seconds).max(0.0);
        for (back, RampPhase { seconds, jerk, snap }) in phases[4..].iter_mut().zip(ramp.phases) {
            *back = RampPhase { seconds, jerk: -jerk, snap: -snap };
        }
        phases
    }
}

/// Returns the speed up to which both halves together use up a way, at most `speed`, and the rest
/// of the way at that speed.
fn top_speed(way: f64, speed: f64, halves: &[Half; 2]) -> [f64; 2] {
    /// Bound that is never reached: double precision is exhausted long before.
    const MAX_STEPS: usize = 50;
    let mut top = speed;
    for _ in 0..MAX_STEPS {
        let [ways, slopes] = halves.iter().fold([0.0; 2], |[ways, slopes], half| {
            let [way, slope] = half.way(top);
            [ways + way, slopes + slope]
        });
        let remaining = way - ways;
        // Newton's method. The ways are convex functions of the speed, so it converges from above
        // without overshoot.
        if remaining >= -ROUNDING * way {
            return [top, remaining.max(0.0)];
        }
        top += remaining / slopes;
    }
    [top, 0.0]
}

/// Duration in s below which phases are dropped: shorter ones are below the resolution of any
/// controller.
const SHORTEST_S: f64 = 1e-9;

/// Share of a duration that is rounding.
const ROUNDING: f64 = 1e-12;

/// Returns the instants between the phases of constant snap, including start and end; phases
/// without duration are dropped.
pub(crate) fn instants(way: f64, limits: &RampedLine<'_>) -> Vec<ProfilePoint> {
    let halves = [0, 1].map(|end| Half::new(limits, end));
    // A short line is not faster than its way over the minimum cruise time.
    let [speed, cruise] =
        top_speed(way, limits.speed.min(way / limits.law.least_cruise_s), &halves);
    let cruise_s = cruise / speed;
    let [start, stop] = halves.map(|half| half.phases(speed));
    // In reverse, acceleration and snap change their signs, and jerk starts with its former end
    // value.
    let backwards = stop.iter().rev().map(|RampPhase { seconds, jerk, snap }| RampPhase {
        seconds: *seconds,
        jerk: jerk + snap * seconds,
        snap: -snap,
    });
    let cruise = RampPhase { seconds: cruise_s, ..RampPhase::default() };
    let phases = start.into_iter().chain([cruise]).chain(backwards);
    let mut instants = vec![ProfilePoint::default()];
    let all_s: f64 = phases.clone().map(|phase| phase.seconds).sum();
    let shortest_s = SHORTEST_S.max(ROUNDING * all_s);
    for phase in phases.filter(|phase| phase.seconds > shortest_s) {
        if let Some(last) = instants.last_mut() {
            let from_here = ProfilePoint { way: 0.0, ..*last };
            let next = phase.after(last);
            (last.phase_s, last.phase_way) = (phase.seconds, phase.after(&from_here).way);
            instants.push(next);
        }
    }
    // The end is set to the exact way and to rest, without rounding.
    if let Some(last) = instants.last_mut() {
        *last = ProfilePoint { t_s: last.t_s, way, ..ProfilePoint::default() };
    }
    instants
}

#[cfg(test)]
mod tests {
    use super::{super::ramp::tests::limits, *};
    use iiwa_kin::Robot;
    use proptest::prelude::*;

    fn instants_of(
        way: f64,
        speed: f64,
        acceleration: f64,
        ends: [RampLimits; 2],
    ) -> Vec<ProfilePoint> {
        let law = *Robot::default().ramp_law();
        instants(way, &RampedLine { speed, acceleration, ends, law: &law })
    }

    fn seconds(instants: &[ProfilePoint]) -> f64 {
        instants.last().map_or(0.0, |last| last.t_s)
    }

    proptest! {
        /// With and without plateau and cruise: phases join, end at rest at the end of the way, and
        /// keep the limits of speed and acceleration.
        #[test]
        fn phases_lead_to_the_end(
            ends in [limits(), limits()],
            speed in 0.01..3.0_f64,
            acceleration in 1.0..30.0_f64,
            power in -9.0..1.5_f64,
        ) {
            let way = 10.0_f64.powf(power);
            let instants = instants_of(way, speed, acceleration, ends);
            let top = speed.min(way / 0.2);
            for pair in instants.windows(2) {
                prop_assert!(pair[0].t_s < pair[1].t_s && pair[0].way <= pair[1].way);
                prop_assert!((pair[0].way + pair[0].phase_way - pair[1].way).abs() < 1e-9 * way);
                prop_assert!(pair[1].speed > -1e-9 * top && pair[1].speed < top * (1.0 + 1e-9));
                prop_assert!(pair[1].acceleration.abs() < acceleration * (1.0 + 1e-9));
            }
            let last = instants[instants.len() - 1];
            prop_assert!(last.way == way && last.speed == 0.0);
        }

        /// A slightly longer way takes slightly longer.
        #[test]
        fn longer_takes_longer(
            ends in [limits(), limits()],
            speed in 0.01..3.0_f64,
            acceleration in 1.0..30.0_f64,
            power in -6.0..1.0_f64,
            more in -7.0..1.0_f64,
        ) {
            let way = 10.0_f64.powf(power);
            let ratio = 1.0 + 10.0_f64.powf(more);
            let [short, long] =
                [way, way * ratio].map(|way| seconds(&instants_of(way, speed, acceleration, ends)));
            prop_assert!(long > short && long < short * ratio * (1.0 + 1e-9), "{short} {long}");
        }
    }
}
