//! Jerk-limited stamps of one section.
//!
//! A section that is one straight line has a closed form. Any other is solved for by [`iiwa_solver`], starting from
//! its acceleration-limited stamps.

mod horizon;
mod stamps;

use std::sync::atomic::AtomicBool;

use iiwa_path::{PLACES, Step};
use iiwa_solver::{LimitedSegment, SolveError, SweptNode};

use crate::{
    limit_usage::LimitUsage,
    node::Node,
    phases::{ProfilePoint, phases},
    section::{PieceKind, Section},
    timing::{JerkOptions, TimingError},
};
use stamps::{SegmentStamps, Stamps};

/// Replaces the acceleration-limited stamps of `section` by jerk-limited ones, unless `stop` is set.
pub(crate) fn limit(
    section: &mut Section,
    options: JerkOptions,
    stop: &AtomicBool,
) -> Result<(), TimingError> {
    let Some(first) = section.pieces.first() else { return Ok(()) };
    let motion = first.motion;
    let path = section.path.clone();
    // The section gets new nodes: in long ones, the memory of these counts.
    let swept: Vec<_> = std::mem::take(&mut section.nodes)
        .into_iter()
        .map(|Node { t_s, p, rate, u, .. }| SweptNode { t_s, p, rate, u })
        .collect();
    let mut segments = Vec::with_capacity(section.pieces.len());
    for piece in &section.pieces {
        let Step::Move { segment, blend, .. } = &path.steps()[piece.step] else { continue };
        let limits = &path.limits()[piece.motion.index()];
        let swept = &swept[piece.nodes.clone()];
        let Some(segment) = LimitedSegment::new(segment.as_ref(), limits, swept) else {
            let motion = blend.map_or(piece.motion, |corner| corner.motion);
            return Err(TimingError::CurvatureJumps { motion });
        };
        segments.push(segment);
    }
    let stamped = match segments.as_slice() {
        [line] if line.is_line() && !options.general => straight(line),
        _ => horizon::stamps(&segments, section.start_s, options, stop).map_err(
            |error| match error {
                SolveError::NotConverged => TimingError::NotConverged { motion },
                SolveError::Interrupted => TimingError::Interrupted,
            },
        )?,
    };
    drop(segments);
    section.stamp(stamped);
    Ok(())
}

/// The stamps of a section that is one line.
fn straight(segment: &LimitedSegment<'_>) -> Stamps {
    let length = segment.length_rad();
    let instants = phases(length, segment.straight(0.0));
    let nodes: Vec<_> = instants
        .iter()
        .map(|at| Node {
            t_s: at.t_s,
            dt_s: at.phase_s,
            p: at.way / length,
            dp: at.phase_way / length,
            rate: at.speed / length,
            u: [at.acceleration / length; 2],
        })
        .collect();
    let mut usage = LimitUsage::default();
    let geometry = segment.geometry(&[0.0; PLACES]);
    for pair in instants.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let dt = from.phase_s;
        let jerk = (to.acceleration - from.acceleration) / dt;
        // Where the phase is half over, and for the peaks also at its end.
        let half = ProfilePoint {
            speed: from.speed + 0.5 * dt * (from.acceleration + 0.25 * dt * jerk),
            acceleration: 0.5 * (from.acceleration + to.acceleration),
            ..from
        };
        for (at, dt) in [(half, dt), (to, 0.0)] {
            let rates = [at.speed, at.acceleration, jerk];
            usage.sample(&segment.shares(&geometry, 0, rates), dt);
        }
    }
    let segments = vec![SegmentStamps { nodes: 0..nodes.len(), usage }];
    Stamps { nodes, segments }
}

impl Section {
    /// Replaces the stamps of its pieces, which all move.
    fn stamp(&mut self, stamps: Stamps) {
        let Stamps { mut nodes, segments, .. } = stamps;
        for (piece, SegmentStamps { nodes: range, usage }) in self.pieces.iter_mut().zip(segments) {
            let own = &mut nodes[range.clone()];
            for i in 1..own.len() {
                own[i - 1].u[1] = own[i].u[0];
            }
            let [start, end] = [own[0].t_s, own[own.len() - 1].t_s];
            let limits = &self.path.limits()[piece.motion.index()];
            let full = &self.path.robot().limits().velocity_rad_s;
            piece.nodes = range;
            piece.start_s = self.start_s + start;
            piece.end_s = self.start_s + end;
            piece.duration_s = end - start;
            piece.peak_velocity_rel = usage.peak_velocity_rel(limits.velocity_rad_s(), full);
            piece.limited_by = Some(usage.limit());
            piece.usage = usage;
            debug_assert!(matches!(piece.kind, PieceKind::Line | PieceKind::Blend));
        }
        nodes.shrink_to_fit();
        self.nodes = nodes;
    }
}
