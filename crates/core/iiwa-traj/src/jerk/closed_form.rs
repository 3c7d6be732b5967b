//! Stamps in closed form: the profile of at most seven phases of constant jerk, for lines in joint
//! space and for TCP lines and circles on which only the TCP limits are active.

use iiwa_kin::{RampLaw, RampLimits};
use iiwa_path::PLACES;
use iiwa_solver::LimitedSegment;

use super::stamps::{SegmentStamps, Stamps};
use crate::{
    interval::Node,
    limit::Limit,
    limit_usage::LimitUsage,
    phases::{ProfilePoint, phases},
    sunrise::{self, RampedLine},
};

/// Minimum number of intervals of a motion. Between nodes, joint motion is polynomial, and limits
/// are checked at nodes and half-way.
const INTERVALS: f64 = 200.0;

/// Largest share of a limit that a joint may use at the checked points, so that it keeps the limit
/// in between as well.
const MAX_SHARE: f64 = 0.99;

/// Returns the stamps of a section that is one line in joint space.
pub(super) fn line(segment: &LimitedSegment<'_>) -> Stamps {
    let length = segment.length_rad();
    let instants = phases(length, segment.straight(0.0));
    let mut usage = LimitUsage::default();
    // The geometry of a line is the same at all places.
    let geometry = segment.geometry(&[0.0; PLACES]);
    for interval in instants.windows(2).map(ConstantJerk::new) {
        for (rates, dt) in interval.rates() {
            usage.sample(&segment.shares(&geometry, 0, rates), dt);
        }
    }
    stamps(&instants, length, &usage)
}

/// Returns the stamps of a section that is one line in joint space, as planned by Sunrise. The ramp
/// law limits jerk and snap.
pub(super) fn sunrise_line(
    segment: &LimitedSegment<'_>,
    ends: [RampLimits; 2],
    law: &RampLaw,
) -> Stamps {
    let length = segment.length_rad();
    let [speed, acceleration, _] = segment.straight(0.0);
    let limits = RampedLine { speed, acceleration, ends, law };
    let instants = sunrise::instants(length, &limits);
    let mut usage = LimitUsage::default();
    let geometry = segment.geometry(&[0.0; PLACES]);
    for pair in instants.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let shares = [from, to].map(|point| point.speed * law.least_cruise_s / length);
        usage.add_speed(Limit::MinimumDuration, shares, from.phase_s);
        // Speed and acceleration are monotonic within a phase.
        let speed = f64::midpoint(from.speed, to.speed);
        let half = [speed, f64::midpoint(from.acceleration, to.acceleration), 0.0];
        for (rates, dt) in [(half, from.phase_s), ([to.speed, to.acceleration, 0.0], 0.0)] {
            usage.sample(&segment.shares(&geometry, 0, rates), dt);
        }
    }
    stamps(&instants, length, &usage)
}

fn stamps(instants: &[ProfilePoint], length: f64, usage: &LimitUsage) -> Stamps {
    let nodes: Vec<Node> = instants.iter().map(|instant| instant.node(length)).collect();
    let segments = vec![SegmentStamps { nodes: 0..nodes.len(), usage: usage.clone() }];
    Stamps { nodes, segments }
}

/// Returns the stamps of a section that is one TCP path; none if other limits than those of the TCP
/// may be active. A motion that is limited by the TCP alone is optimal: the TCP limits admit no
/// faster one.
pub(super) fn tcp_path(segment: &LimitedSegment<'_>) -> Option<Stamps> {
    let limits = segment.even_tool_limits()?;
    let length = segment.length_rad();
    let instants = divided(&phases(length, limits));
    let intervals: Vec<ConstantJerk> = instants.windows(2).map(ConstantJerk::new).collect();
    let mut usage = LimitUsage::default();
    for some in intervals.chunks(PLACES / 2) {
        let mut sigma = [length; PLACES];
        for (places, interval) in sigma.chunks_mut(2).zip(some) {
            places.copy_from_slice(&interval.samples.map(|sample| sample.way));
        }
        let geometry = segment.geometry(&sigma);
        for (i, interval) in some.iter().enumerate() {
            for (k, (rates, dt)) in interval.rates().into_iter().enumerate() {
                let shares = segment.shares(&geometry, 2 * i + k, rates);
                let joints = shares.values().flat_map(|shares| &shares[..7]);
                if !joints.into_iter().all(|share| share.abs() <= MAX_SHARE) {
                    return None;
                }
                usage.sample(&shares, dt);
            }
        }
    }
    Some(stamps(&instants, length, &usage))
}

/// Interval of constant jerk.
struct ConstantJerk {
    dt_s: f64,
    jerk: f64,
    /// States half-way in time and at the end.
    samples: [ProfilePoint; 2],
}

impl ConstantJerk {
    fn new(pair: &[ProfilePoint]) -> Self {
        let [from, to] = [pair[0], pair[1]];
        let dt_s = from.phase_s;
        let jerk = (to.acceleration - from.acceleration) / dt_s;
        Self { dt_s, jerk, samples: [from.after(0.5 * dt_s, jerk), to] }
    }

    /// Returns speed, acceleration and jerk at the samples, each with its weight in time: the end
    /// only contributes to peaks.
    fn rates(&self) -> [([f64; 3], f64); 2] {
        let [half, end] =
            self.samples.map(|instant| [instant.speed, instant.acceleration, self.jerk]);
        [(half, self.dt_s), (end, 0.0)]
    }
}

/// Divides the phases of a profile into shorter intervals.
fn divided(instants: &[ProfilePoint]) -> Vec<ProfilePoint> {
    let whole_s = instants.last().map_or(0.0, |last| last.t_s);
    let mut all = Vec::new();
    for pair in instants.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let jerk = (to.acceleration - from.acceleration) / from.phase_s;
        let parts = (INTERVALS * from.phase_s / whole_s).ceil();
        let dt_s = from.phase_s / parts;
        let mut part = 0.0;
        while part < parts {
            let instant = from.after(part * dt_s, jerk);
            all.push(ProfilePoint {
                phase_s: dt_s,
                phase_way: instant.way_in(dt_s, jerk),
                ..instant
            });
            part += 1.0;
        }
    }
    all.extend(instants.last());
    all
}
