//! Limits as a drive measures them: means of velocity, acceleration and jerk over a short time.

use iiwa_kin::Joints;
use iiwa_program::LimitKind;
use iiwa_traj::{State, Trajectory};

use crate::differences::{largest, ratio};

/// Largest ratios of the means over `window_s` to the limits of each kind.
///
/// A mean is the change of the next lower derivative over the window. Windows start, end and are
/// centred at nodes and halfway between them, since means are largest near these points. If a
/// window spans several motions, the larger limit applies.
#[must_use]
pub fn mean_ratios(trajectory: &Trajectory, window_s: f64) -> [f64; 3] {
    let path = trajectory.path();
    let mut worst = [0.0_f64; 3];
    let mut window = |start: &State, end: &State| {
        // Late in a long program, times are rounded. Windows truncated at its start or its end show
        // rounding, not means.
        let seconds = end.t_s - start.t_s;
        if seconds < 0.5 * window_s {
            return;
        }
        let mean =
            |from: &Joints, to: &Joints| std::array::from_fn(|j| (to[j] - from[j]) / seconds);
        let means = [mean(&start.q, &end.q), mean(&start.dq, &end.dq), mean(&start.ddq, &end.ddq)];
        for ((worst, mean), kind) in worst.iter_mut().zip(&means).zip(LimitKind::ALL) {
            *worst = worst.max(ratio(
                mean,
                &largest((start.step..=end.step).map(|step| path.limits_of(step)), kind),
            ));
        }
    };
    let end_s = trajectory.cycle_time_s();
    for section in trajectory.sections() {
        for piece in section.pieces() {
            for pair in section.nodes(piece).windows(2) {
                let [from, to] = [pair[0].t_s, pair[1].t_s].map(|t_s| section.start_s() + t_s);
                for t_s in [from, f64::midpoint(from, to)] {
                    let state_at = |t_s: f64| trajectory.at(t_s.max(0.0).min(end_s));
                    let [before, center, after] =
                        [state_at(t_s - window_s), state_at(t_s), state_at(t_s + window_s)];
                    window(&before, &center);
                    window(&center, &after);
                    window(&state_at(t_s - 0.5 * window_s), &state_at(t_s + 0.5 * window_s));
                }
            }
        }
    }
    worst
}
