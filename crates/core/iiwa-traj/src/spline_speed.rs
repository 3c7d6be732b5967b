//! Speed along splines as recorded under Sunrise: a model, [`iiwa_kin::SplineSpeed`].
//!
//! The model limits the TCP speed and its first two derivatives at each point of the path. The
//! jerk-limited solver gets these limits in the form of joint limits ([`limits`]), and an initial
//! motion ([`sweep`]). The ramps next to rest are those of PTP motions ([`EndRamp`]).

mod held_speed;
mod limits;
mod sweep;

#[cfg(test)]
mod tests;

use std::sync::{Arc, atomic::AtomicBool};

use iiwa_kin::{RampEnd, vector};
use iiwa_path::{JointPath, Segment, Step};
use iiwa_program::LimitKind;
use iiwa_solver::{LimitedSegment, SolveError};

use crate::{
    grid::Grid,
    interval::Node,
    jerk::{self, Stamps},
    limit::Limit,
    limit_usage::LimitUsage,
    sampled_usage::{sampled_usage, samples},
    section::{Piece, Section},
    section_sweep::SAMPLES_BEFORE_JERK,
    sunrise::{EndRamp, ramp_limits},
    timing::{JerkOptions, TimingError},
};
use held_speed::HeldSpeed;
use limits::SpeedLimitedSegment;
use sweep::SplineSweep;

/// Ratio of the velocity limits to those used for planning: slightly above the solver's tolerance,
/// so that joints keep their limits.
const SLOWER: f64 = 1.001;

/// Largest number of plans of a spline; each one lowers the speeds by the excess of the joints in
/// the previous one. The active velocity limit changes from joint to joint, and has kinks there
/// that the solver's checks may miss.
const ROUNDS: usize = 4;

/// Factor of refinement of the cells: the model's speed limits have narrow minima.
const FINER: f64 = 2.0;

/// Limits the jerk of `section`, a spline or a part of one between two stops, by the model. Returns
/// false, and leaves the section as it is, if the model has no solution.
pub(crate) fn limit(
    section: &mut Section,
    options: JerkOptions,
    stop: &AtomicBool,
) -> Result<bool, TimingError> {
    match stamps(section, options, stop) {
        Ok(stamps) => {
            section.stamp(stamps);
            Ok(true)
        }
        Err(SolveError::Interrupted) => Err(TimingError::Interrupted),
        Err(SolveError::NotConverged) => Ok(false),
    }
}

/// Finds the stamps of a section that is a spline, or a part of one between two stops.
fn stamps(
    section: &Section,
    options: JerkOptions,
    stop: &AtomicBool,
) -> Result<Stamps, SolveError> {
    let grid = Grid::new(SAMPLES_BEFORE_JERK);
    let segments = model_segments(&section.path, &section.pieces, &grid);
    let segments = segments.ok_or(SolveError::NotConverged)?;
    let swept = SplineSweep::new(&segments, &grid).nodes();
    let options = JerkOptions { refinement: FINER * options.refinement, ..options };
    let mut slower = SLOWER;
    for _ in 0..ROUNDS {
        let limits: Vec<_> = segments.iter().map(|segment| segment.joint_limits(slower)).collect();
        let limited: Option<Vec<_>> = std::iter::zip(&segments, &limits)
            .zip(&swept)
            .map(|((segment, limits), swept)| LimitedSegment::new(segment, limits, swept))
            .collect();
        let limited = limited.ok_or(SolveError::NotConverged)?;
        let mut stamps = jerk::from_rest_to_rest(&limited, section.start_s, options, stop)?;
        let mut largest = 0.0_f64;
        for ((segment_stamps, segment), swept) in
            stamps.segments.iter_mut().zip(&segments).zip(&swept)
        {
            let (shape, limits) = segment.shape_and_limits();
            let limited =
                LimitedSegment::new(shape, limits, swept).ok_or(SolveError::NotConverged)?;
            let nodes = &stamps.nodes[segment_stamps.nodes.clone()];
            // The model does not keep acceleration and jerk limits.
            segment_stamps.usage = sampled_usage(&limited, nodes, true);
            add_minimum_duration(&mut segment_stamps.usage, segment, nodes);
            largest = largest.max(segment_stamps.usage.peak_velocity_rel(&[1.0; 7], &[1.0; 7]));
        }
        if largest <= 1.0 {
            return Ok(stamps);
        }
        slower *= SLOWER * largest;
    }
    Err(SolveError::NotConverged)
}

/// Adds the usage of the speed at which the whole way takes the minimum duration.
fn add_minimum_duration(usage: &mut LimitUsage, segment: &SpeedLimitedSegment<'_>, nodes: &[Node]) {
    for (p, state, dt_s) in samples(nodes) {
        let share = segment.cruise_share(p, state.rate);
        usage.add_speed(Limit::MinimumDuration, [share; 2], dt_s);
    }
}

/// Returns the segments of `pieces`, all between two rests, under the model's limits. None if a
/// ramp next to rest has no positive, finite parameters.
fn model_segments<'a>(
    path: &'a JointPath,
    pieces: &[Piece],
    grid: &Grid,
) -> Option<Vec<SpeedLimitedSegment<'a>>> {
    let (full, law) = (path.full_limits(), path.ramp_law());
    let segment = |piece: &Piece| {
        let Step::Move { segment, .. } = &path.steps()[piece.step] else { return None };
        let limits = path.limits_of(piece.step);
        Some(SpeedLimitedSegment::new(segment.as_ref(), limits, &full, law.spline))
    };
    let mut segments: Vec<_> = pieces.iter().map(segment).collect::<Option<_>>()?;
    place(&mut segments, grid, law.least_cruise_s);
    let speeds = SplineSweep::new(&segments, grid).speeds();
    let held_speed = Arc::new(HeldSpeed::new(&speeds, law.spline.hold_s));
    for segment in &mut segments {
        segment.set_held(Arc::clone(&held_speed));
    }
    // Again, because the ramps depend on the held speeds.
    let sweep = SplineSweep::new(&segments, grid);
    let ramps = RampEnd::BOTH.map(|end| end_ramp(path, pieces, &segments, &sweep, end));
    let [Some(start), Some(stop)] = ramps else { return None };
    for segment in &mut segments {
        segment.set_ramps([start, stop]);
    }
    Some(segments)
}

/// Sets the distances of segments from rest, and the TCP speed at which the whole way takes
/// `min_cruise_s`.
fn place(segments: &mut [SpeedLimitedSegment<'_>], grid: &Grid, min_cruise_s: f64) {
    let way: f64 = segments.iter().map(|segment| segment.way(grid)).sum();
    let all_rad: f64 = segments.iter().map(Segment::sigma_length_rad).sum();
    let mut before_rad = 0.0;
    for segment in segments {
        let length_rad = segment.sigma_length_rad();
        let after_rad = (all_rad - before_rad - length_rad).max(0.0);
        segment.set_place([before_rad, after_rad], way / min_cruise_s);
        before_rad += length_rad;
    }
}

/// Returns the ramp at one end; none if the joints do not move there.
fn end_ramp(
    path: &JointPath,
    pieces: &[Piece],
    segments: &[SpeedLimitedSegment<'_>],
    sweep: &SplineSweep,
    end: RampEnd,
) -> Option<EndRamp> {
    let (index, s) = match end {
        RampEnd::Start => (0, 0.0),
        RampEnd::Stop => (segments.len() - 1, 1.0),
    };
    let segment = &segments[index];
    let (shape, limits) = segment.shape_and_limits();
    let limits_here = segment.limits_at(s);
    let of_tcp = limits.tool().way[LimitKind::Velocity];
    let top = sweep.top_speed();
    let speed = if segment.has_way() { top.min(of_tcp) } else { top };
    let [direction, ..] = shape.sigma_derivatives(s);
    let rate = vector::norm(&direction);
    let acceleration = vector::largest_multiple(&direction, limits.acceleration_rad_s2());
    let of_ramp = ramp_limits(path, pieces, end)?;
    let [speed, cruise, acceleration] =
        [speed / limits_here.way[0], segment.cruise() / limits_here.way[0], acceleration]
            .map(|of_sigma| rate * of_sigma);
    EndRamp::new(
        [speed, acceleration],
        cruise,
        &of_ramp,
        &path.ramp_law(),
        sweep.way_to_limit_rad(end),
    )
}
