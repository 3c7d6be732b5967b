//! Usage of joint and TCP limits by a motion, from samples.

use iiwa_path::PLACES;
use iiwa_solver::LimitedSegment;

use crate::{
    interval::{IntervalProgress, Node, progress},
    limit_usage::LimitUsage,
};

/// Sampled points per interval between nodes.
const SAMPLES: u32 = 4;

/// Returns the usage of a segment's limits by the motion between `nodes`. The motion need not keep
/// its limits: shares above 1 are the values that it reaches. Without `has_jerk_limits`, the motion
/// uses no jerk limit.
pub(crate) fn sampled_usage(
    segment: &LimitedSegment<'_>,
    nodes: &[Node],
    has_jerk_limits: bool,
) -> LimitUsage {
    let mut usage = LimitUsage::default();
    let length_rad = segment.length_rad();
    let samples: Vec<_> = samples(nodes).collect();
    for some in samples.chunks(PLACES) {
        let sigma = std::array::from_fn(|i| some[i.min(some.len() - 1)].0 * length_rad);
        let geometry = segment.geometry(&sigma);
        for (place, (_, state, dt_s)) in some.iter().enumerate() {
            let jerk = if has_jerk_limits { state.du } else { 0.0 };
            let rates = [state.rate, state.u, jerk].map(|rate| rate * length_rad);
            usage.sample(&segment.shares(&geometry, place, rates), *dt_s);
        }
    }
    usage
}

/// Returns samples of the motion between `nodes`: p, state and duration in s.
pub(crate) fn samples(nodes: &[Node]) -> impl Iterator<Item = (f64, IntervalProgress, f64)> {
    nodes.windows(2).flat_map(|pair| {
        let dt_s = pair[0].dt_s / f64::from(SAMPLES);
        (0..SAMPLES).map(move |i| {
            let state = progress((f64::from(i) + 0.5) * dt_s, &pair[0], &pair[1]);
            (pair[0].p + state.dp, state, dt_s)
        })
    })
}
