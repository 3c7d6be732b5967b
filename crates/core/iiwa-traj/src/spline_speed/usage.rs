//! Usage of joint and TCP limits by a motion of the spline model.

use iiwa_path::PLACES;
use iiwa_solver::LimitedSegment;

use crate::{
    interval::{IntervalProgress, Node, progress},
    limit_usage::LimitUsage,
};

/// Sampled points per interval between nodes.
const SAMPLES: u32 = 4;

/// Returns the usage of a segment's limits by the motion between `nodes`. The model does not keep
/// acceleration and jerk limits: shares above 1 are the values that the motion reaches.
pub(super) fn usage(segment: &LimitedSegment<'_>, nodes: &[Node]) -> LimitUsage {
    let mut usage = LimitUsage::default();
    let length_rad = segment.length_rad();
    let samples: Vec<(f64, IntervalProgress, f64)> = nodes
        .windows(2)
        .flat_map(|pair| {
            let dt_s = pair[0].dt_s / f64::from(SAMPLES);
            (0..SAMPLES).map(move |i| {
                let state = progress((f64::from(i) + 0.5) * dt_s, &pair[0], &pair[1]);
                (pair[0].p + state.dp, state, dt_s)
            })
        })
        .collect();
    for some in samples.chunks(PLACES) {
        let sigma = std::array::from_fn(|i| some[i.min(some.len() - 1)].0 * length_rad);
        let geometry = segment.geometry(&sigma);
        for (place, (_, state, dt_s)) in some.iter().enumerate() {
            let rates = [state.rate, state.u, state.du].map(|rate| rate * length_rad);
            usage.sample(&segment.shares(&geometry, place, rates), *dt_s);
        }
    }
    usage
}
