//! Stamps in closed form: the profile of at most seven phases of constant jerk along a line in joint space, and along a line
//! or circle of the TCP that its own limits hold back.

use iiwa_kin::{RampLaw, RampLimits};
use iiwa_path::PLACES;
use iiwa_solver::LimitedSegment;

use super::stamps::{SegmentStamps, Stamps};
use crate::{
    limit_usage::LimitUsage,
    node::Node,
    phases::{ProfilePoint, phases},
    sunrise::{self, RampedLine},
};

/// Intervals of a motion, at least. Between nodes, joints go as polynomials; and limits are checked at nodes and half-way.
const INTERVALS: f64 = 200.0;

/// The largest share of a limit that a joint may use at what is checked: then it keeps the limit in between, too.
const MOST_SHARE: f64 = 0.99;

/// The stamps of a section that is one line in joint space.
pub(super) fn line(segment: &LimitedSegment<'_>) -> Stamps {
    let length = segment.length_rad();
    let instants = phases(length, segment.straight(0.0));
    let mut usage = LimitUsage::default();
    let geometry = segment.geometry(&[0.0; PLACES]);
    for interval in instants.windows(2).map(ConstantJerk::new) {
        for (rates, dt) in interval.rates() {
            usage.sample(&segment.shares(&geometry, 0, rates), dt);
        }
    }
    stamps(&instants, length, &usage)
}

/// The stamps of a section that is one line in joint space, as Sunrise plans it. Its own limits hold jerk and snap back.
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
        // Speed and acceleration grow or fall all through a phase.
        let speed = f64::midpoint(from.speed, to.speed);
        let half = [speed, f64::midpoint(from.acceleration, to.acceleration), 0.0];
        for (rates, dt) in [(half, from.phase_s), ([to.speed, to.acceleration, 0.0], 0.0)] {
            usage.sample(&segment.shares(&geometry, 0, rates), dt);
        }
    }
    stamps(&instants, length, &usage)
}

fn stamps(instants: &[ProfilePoint], length: f64, usage: &LimitUsage) -> Stamps {
    let nodes: Vec<Node> = instants.iter().map(|at| at.node(length)).collect();
    let segments = vec![SegmentStamps { nodes: 0..nodes.len(), usage: usage.clone() }];
    Stamps { nodes, segments }
}

/// The stamps of a section that is one path of the TCP; none if a joint or more than the limits of the TCP hold it back.
/// What keeps the joints' limits as well is the fastest that there is: the TCP's limits alone allow no faster motion.
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
                if !joints.into_iter().all(|share| share.abs() <= MOST_SHARE) {
                    return None;
                }
                usage.sample(&shares, dt);
            }
        }
    }
    Some(stamps(&instants, length, &usage))
}

/// A time of constant jerk.
struct ConstantJerk {
    dt_s: f64,
    jerk: f64,
    /// Half-way in time, and at its end.
    samples: [ProfilePoint; 2],
}

impl ConstantJerk {
    fn new(pair: &[ProfilePoint]) -> Self {
        let [from, to] = [pair[0], pair[1]];
        let dt_s = from.phase_s;
        let jerk = (to.acceleration - from.acceleration) / dt_s;
        Self { dt_s, jerk, samples: [from.after(0.5 * dt_s, jerk), to] }
    }

    /// Speed, acceleration and jerk at the samples, with the time that each stands for: the end is for the peaks alone.
    fn rates(&self) -> [([f64; 3], f64); 2] {
        let [half, end] = self.samples.map(|at| [at.speed, at.acceleration, self.jerk]);
        [(half, self.dt_s), (end, 0.0)]
    }
}

/// A profile with instants within its phases.
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
            let at = from.after(part * dt_s, jerk);
            all.push(ProfilePoint { phase_s: dt_s, phase_way: at.way_in(dt_s, jerk), ..at });
            part += 1.0;
        }
    }
    all.extend(instants.last());
    all
}
