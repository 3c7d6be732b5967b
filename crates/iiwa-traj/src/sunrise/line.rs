//! From rest to rest along a line in joint space, as Sunrise plans it: ramps of acceleration, plateau, cruise.

use iiwa_kin::{RampLaw, RampLimits};

use super::{
    ramp::{Ramp, RampPhase},
    root::root,
};
use crate::phases::ProfilePoint;

/// The limits of a line, in rad along it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RampedLine<'a> {
    /// Largest speed, in rad/s.
    pub(crate) speed: f64,
    /// Largest acceleration, in rad/s^2.
    pub(crate) acceleration: f64,
    /// At its start and at its end.
    pub(crate) ends: [RampLimits; 2],
    pub(crate) law: &'a RampLaw,
}

/// From rest to a speed.
struct Half {
    /// Ramp, plateau, ramp back.
    phases: [RampPhase; 7],
    way: f64,
}

impl Half {
    fn new(speed: f64, limits: &RampedLine<'_>, end: usize) -> Self {
        let ramp =
            Ramp::below(speed, limits.acceleration, &limits.ends[end], limits.law.width_rad_s);
        let plateau = (speed / ramp.acceleration - ramp.seconds).max(0.0);
        let mut phases = [RampPhase::default(); 7];
        phases[..3].copy_from_slice(&ramp.phases);
        phases[3].seconds = plateau;
        for (back, RampPhase { seconds, jerk, snap }) in phases[4..].iter_mut().zip(ramp.phases) {
            *back = RampPhase { seconds, jerk: -jerk, snap: -snap };
        }
        let end = phases.iter().fold(ProfilePoint::default(), |at, phase| phase.after(&at));
        Self { phases, way: end.way }
    }
}

impl RampPhase {
    /// The state at the end of a phase, from that at its start.
    fn after(&self, from: &ProfilePoint) -> ProfilePoint {
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

/// Phases that are shorter than this, in s, are left out: no controller could tell them.
const SHORTEST_S: f64 = 1e-9;

/// Share of a duration that is rounding.
const ROUNDING: f64 = 1e-12;

/// The instants between the phases of constant snap, the start and the end among them; phases that take no time are left out.
pub(crate) fn instants(way: f64, limits: &RampedLine<'_>) -> Vec<ProfilePoint> {
    let halves = |speed: f64| [0, 1].map(|end| Half::new(speed, limits, end));
    let room = |halves: &[Half; 2]| way - halves[0].way - halves[1].way;
    let mut speed = limits.speed.min(way / limits.law.least_cruise_s);
    let mut both = halves(speed);
    let least_room = room(&both);
    if least_room < 0.0 {
        let value = |speed: f64| room(&halves(speed));
        speed = root([0.0, speed], [way, least_room], 1e-14 * way, value);
        both = halves(speed);
    }
    let cruise_s = (room(&both) / speed).max(0.0);
    let [start, stop] = both;
    // Backwards, acceleration and snap change their signs, and jerk begins with what it ended with.
    let backwards = stop.phases.iter().rev().map(|RampPhase { seconds, jerk, snap }| RampPhase {
        seconds: *seconds,
        jerk: jerk + snap * seconds,
        snap: -snap,
    });
    let cruise = RampPhase { seconds: cruise_s, ..RampPhase::default() };
    let phases = start.phases.into_iter().chain([cruise]).chain(backwards);
    let mut instants = vec![ProfilePoint::default()];
    let all_s: f64 = phases.clone().map(|phase| phase.seconds).sum();
    let shortest_s = SHORTEST_S.max(ROUNDING * all_s);
    for phase in phases.filter(|phase| phase.seconds > shortest_s) {
        if let Some(at) = instants.last_mut() {
            let from_here = ProfilePoint { way: 0.0, ..*at };
            let next = phase.after(at);
            (at.phase_s, at.phase_way) = (phase.seconds, phase.after(&from_here).way);
            instants.push(next);
        }
    }
    // Exactly there and exactly at rest, not but for rounding.
    if let Some(last) = instants.last_mut() {
        *last = ProfilePoint { t_s: last.t_s, way, ..ProfilePoint::default() };
    }
    instants
}
