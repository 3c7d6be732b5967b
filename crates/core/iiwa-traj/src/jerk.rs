//! Jerk-limited stamps of one section.
//!
//! A section that is one straight line has a closed form, and so has a TCP path on which only the
//! TCP limits are active. All others are computed by [`iiwa_solver`], with their
//! acceleration-limited stamps as the start.

mod closed_form;
mod horizon;
mod rest_ramps;
mod stamps;

use std::{ops::Range, sync::atomic::AtomicBool};

use iiwa_kin::RampEnd;
use iiwa_path::Step;
use iiwa_solver::{LimitedSegment, SolveError, SweptNode, Window};

use crate::{
    interval::Node,
    path_limits::StepLimits,
    section::{Piece, Section},
    sunrise::ramp_limits,
    timing::{JerkOptions, TimingError},
};
use stamps::Stamper;
pub(crate) use stamps::{SegmentStamps, Stamps};

/// Replaces the acceleration-limited stamps of `section` by jerk-limited ones, unless `stop` is
/// set. Further `limits` of each piece are kept as well, if there are any.
pub(crate) fn limit(
    section: &mut Section,
    limits: &[StepLimits],
    timing: JerkTiming,
    stop: &AtomicBool,
) -> Result<(), TimingError> {
    if !section.pieces.is_empty() {
        let all = Pieces { range: 0..section.pieces.len(), ends: [None; 2], limits };
        let stamped = stamps(section, &all, timing, stop)?;
        section.stamp(stamped);
    }
    Ok(())
}

/// Options of jerk-limited timing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JerkTiming {
    pub(crate) options: JerkOptions,
    /// `true` if lines from rest to rest follow the robot's [`RampLaw`](iiwa_kin::RampLaw) and
    /// splines its [`SplineSpeed`](iiwa_kin::SplineSpeed).
    pub(crate) sunrise: bool,
}

/// Pieces of a section, at least one.
pub(crate) struct Pieces<'a> {
    pub(crate) range: Range<usize>,
    /// State at the start and at the end: the squared speed along the path (rad^2/s^2) and its
    /// derivative with respect to the way (rad/s^2); none at rest.
    pub(crate) ends: [Option<[f64; 2]>; 2],
    /// Further limits of each piece of the section, if any.
    pub(crate) limits: &'a [StepLimits],
}

/// Finds the jerk-limited stamps of some `pieces` of `section`. The section loses its
/// acceleration-limited stamps.
pub(crate) fn stamps(
    section: &mut Section,
    pieces: &Pieces<'_>,
    JerkTiming { options, sunrise }: JerkTiming,
    stop: &AtomicBool,
) -> Result<Stamps, TimingError> {
    let path = section.path.clone();
    // The section gets new nodes: in long sections, the memory of the old ones is significant.
    let swept: Vec<_> = std::mem::take(&mut section.nodes)
        .into_iter()
        .map(|Node { t_s, p, rate, u, .. }| SweptNode { t_s, p, rate, u })
        .collect();
    let mut segments = Vec::with_capacity(section.pieces.len());
    for (i, piece) in section.pieces.iter().enumerate() {
        let Step::Move { segment, blend, .. } = &path.steps()[piece.step] else { continue };
        let limits = path.limits_of(piece.step);
        let swept = &swept[piece.nodes.clone()];
        let Some(segment) = LimitedSegment::new(segment.as_ref(), limits, swept) else {
            let motion = blend.map_or(piece.motion, |corner| corner.motion);
            return Err(TimingError::CurvatureJumps { motion });
        };
        segments.push(match pieces.limits.get(i) {
            Some(limits) => segment.with_rows(&limits.rows),
            None => segment,
        });
    }
    let rests = pieces.ends.map(|end| end.is_none());
    let is_closed = rests == [true; 2] && pieces.limits.is_empty() && !options.general;
    if let [line] = segments.as_slice()
        && is_closed
        && line.is_line()
    {
        if !sunrise {
            return Ok(closed_form::line(line).joined());
        }
        let ends = RampEnd::BOTH.map(|end| ramp_limits(&path, &section.pieces, end));
        if let [Some(start), Some(stop)] = ends {
            return Ok(closed_form::sunrise_line(line, [start, stop], &path.ramp_law()).joined());
        }
    }
    if sunrise {
        rest_ramps::soften(&mut segments, &path, &section.pieces, rests);
    }
    if let [path] = segments.as_slice()
        && is_closed
        && let Some(stamps) = closed_form::tcp_path(path)
    {
        return Ok(stamps.joined());
    }
    let stamps = match (segments.as_slice(), pieces.ends) {
        (all, [None, None]) => horizon::stamps(all, section.start_s, options, stop),
        (segments, [entry, exit]) => {
            let window = Window { segments, range: pieces.range.clone(), entry, exit };
            window_stamps(&window, options, stop)
        }
    };
    let motion = section.pieces[pieces.range.start].motion;
    stamps.map(|stamps| stamps.joined().named(pieces.limits)).map_err(|error| match error {
        SolveError::NotConverged => TimingError::NotConverged { motion },
        SolveError::Interrupted => TimingError::Interrupted,
    })
}

/// Finds the stamps of segments from rest to rest.
pub(crate) fn from_rest_to_rest(
    segments: &[LimitedSegment<'_>],
    start_s: f64,
    options: JerkOptions,
    stop: &AtomicBool,
) -> Result<Stamps, SolveError> {
    horizon::stamps(segments, start_s, options, stop).map(Stamps::joined)
}

/// Finds the stamps of a window. Its end states are given, so it cannot be slowed down as a whole.
fn window_stamps(
    window: &Window<'_, '_>,
    options: JerkOptions,
    stop: &AtomicBool,
) -> Result<Stamps, SolveError> {
    let solution = horizon::solve(window, options, stop)?.ok_or(SolveError::NotConverged)?;
    let mut stamper = Stamper::new(0.0, window.range.start);
    stamper.add(&solution, window, window.range.end);
    Ok(stamper.finish())
}

impl Section {
    /// Replaces the stamps of the section's pieces, all of which move.
    pub(crate) fn stamp(&mut self, Stamps { mut nodes, segments }: Stamps) {
        let pieces = self.pieces.iter().zip(segments).filter_map(|(piece, stamps)| {
            let SegmentStamps { nodes: range, usage } = stamps;
            let times_s = [nodes[range.start].t_s, nodes[range.end - 1].t_s];
            Piece::moving(self, piece.step, times_s, &usage, range)
        });
        self.pieces = pieces.collect();
        nodes.shrink_to_fit();
        self.nodes = nodes;
    }
}

impl Stamps {
    /// Sets the second derivative at the end of each interval to the one at the next node, since it
    /// is continuous.
    fn joined(mut self) -> Self {
        for SegmentStamps { nodes, .. } in &self.segments {
            let segment_nodes = &mut self.nodes[nodes.clone()];
            for i in 1..segment_nodes.len() {
                segment_nodes[i - 1].u[1] = segment_nodes[i].u[0];
            }
        }
        self
    }

    /// Names the further limits of the segments; the first segment is that of the first of
    /// `limits`.
    fn named(mut self, limits: &[StepLimits]) -> Self {
        for (segment, StepLimits { limits, .. }) in self.segments.iter_mut().zip(limits) {
            segment.usage.name_rows(limits);
        }
        self
    }
}
