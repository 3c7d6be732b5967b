//! Assumptions about the controller and its inputs that a plan's time depends on, as opposed to
//! measurements.

use std::collections::HashSet;

use iiwa_program::{IoEntry, IoKind, LimitKind, MotionIndex};
use iiwa_traj::{Limit, PieceKind, Section};
use serde::{Deserialize, Serialize};

/// An assumption about the controller or its inputs that a program's time depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct AssumptionRecord {
    /// Text of the assumption.
    pub what: String,
    /// Number of motions that depend on it.
    pub motions: usize,
    /// First of these motions, from 1.
    pub first: usize,
}

const BLEND: &str = "blends are planned with jerk limits, and with starts and stops as soft as \
                     recorded ones; no blend has been recorded";
const PATH: &str = "LIN and CIRC: jerk limits, with starts and stops as soft as those of recorded \
                    SPL; neither has been recorded";
const SPLINE: &str = "splines: a model of their speed, which matches recorded durations within 2 % \
                      (2.7 % for splines left out of the fit)";
const CRUISE: &str = "PTP without a cruise or without a plateau of acceleration: the ramp law is \
                      extrapolated beyond the recordings";
const LOAD: &str = "load: the ramp law treats it as a part of the arm; no recording has a load";
const JERK_REL: &str = "jerk_rel: scales jerk and snap of ramps; no recording has this setting";
const PAUSE: &str =
    "standstill after motions that the program waits for: 93 ms, the mean of 87 to 99 ms";
const T1: &str = "T1: 225 mm/s at any override, and in blends; recorded for PTP at 50 %";
const JERK: &str = "stops: within jerk limits; a real robot's PTP motions take 4 % longer";
const OVERRIDE: &str =
    "override: scales the time of blends and TCP paths; recorded for PTP and splines";

/// Assumptions about the controller that the time of a section depends on, each with a motion, for
/// the timing method of this name.
#[must_use]
pub fn section_assumptions(section: &Section, timing: &str) -> Vec<(&'static str, MotionIndex)> {
    let mut assumptions = Vec::new();
    if timing != "sunrise" {
        let stops = section.pieces().iter().find(|piece| piece.kind == PieceKind::Settle);
        assumptions.extend(stops.map(|piece| (JERK, piece.motion)));
        return assumptions;
    }
    let path = section.path();
    let moving = section.pieces().iter().filter(|piece| piece.kind.moves());
    let alone = moving.clone().count() == 1;
    for piece in moving {
        let limits = path.limits_of(piece.step);
        let mut add = |text| assumptions.push((text, piece.motion));
        match piece.kind {
            PieceKind::Lin | PieceKind::Circ => add(PATH),
            PieceKind::Spline if alone || !has_blends(section) => add(SPLINE),
            PieceKind::Blend | PieceKind::Spline => add(BLEND),
            PieceKind::Line if alone => {
                let kinds = [LimitKind::Velocity, LimitKind::Acceleration];
                let reached = |kind| piece.limits().iter().any(|active| is_of(active.limit, kind));
                if !kinds.into_iter().all(reached) && limits.supervised_m_s().is_none() {
                    add(CRUISE);
                }
                if path.load(piece.motion).is_some() {
                    add(LOAD);
                }
                let shares = limits.jerk_shares(&path.full_limits());
                if shares.into_iter().any(|share| share < 1.0 - 1e-9) {
                    add(JERK_REL);
                }
            }
            _ => {}
        }
        if limits.supervised_m_s().is_some() {
            add(T1);
        }
        let recorded = matches!(piece.kind, PieceKind::Line | PieceKind::Spline) && alone;
        if path.speed_override() < 1.0 && !recorded {
            add(OVERRIDE);
        }
    }
    let blocks = section.pieces().iter().find(|piece| section.is_blocking(piece));
    assumptions.extend(blocks.map(|piece| (PAUSE, piece.motion)));
    assumptions
}

fn has_blends(section: &Section) -> bool {
    section.pieces().iter().any(|piece| piece.kind == PieceKind::Blend)
}

fn is_of(limit: Limit, wanted: LimitKind) -> bool {
    matches!(limit, Limit::Motion { kind, .. } if kind == wanted)
}

/// Adds the assumption about an input; an output is not assumed.
pub(crate) fn add_io(records: &mut Vec<AssumptionRecord>, motion: MotionIndex, entry: &IoEntry) {
    let IoKind::WaitFor { seconds } = entry.kind else { return };
    let what = format!("wait_for: {} = {} after {seconds} s", entry.io, entry.value);
    match records.iter_mut().find(|record| record.what == what) {
        Some(record) => record.motions += 1,
        None => records.push(AssumptionRecord { what, motions: 1, first: motion.number() }),
    }
}

/// Adds the assumptions of a section.
pub(crate) fn add(
    records: &mut Vec<AssumptionRecord>,
    counted: &mut CountedAssumptions,
    section: &Section,
    timing: &str,
) {
    // A motion with several pieces or sections, such as a spline, counts once.
    let mut seen: HashSet<_> = counted.0.drain(..).collect();
    for (text, motion) in section_assumptions(section, timing) {
        if !seen.insert((text, motion)) {
            continue;
        }
        match records.iter_mut().find(|record| record.what == text) {
            Some(record) => record.motions += 1,
            None => records.push(AssumptionRecord {
                what: text.to_owned(),
                motions: 1,
                first: motion.number(),
            }),
        }
    }
    let last = section.pieces().last().map(|piece| piece.motion);
    counted.0.extend(seen.into_iter().filter(|(_, motion)| Some(*motion) == last));
}

/// Assumptions that are counted for the last motion of a section, which the next section may
/// continue.
#[derive(Clone, Debug, Default)]
pub(crate) struct CountedAssumptions(Vec<(&'static str, MotionIndex)>);

/// The state of a calculation and not a figure: all are equal.
impl PartialEq for CountedAssumptions {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
