//! Limits as a drive sees them: means of velocity, acceleration and jerk over a short time.

use iiwa_kin::Joints;
use iiwa_path::MotionLimits;
use iiwa_traj::{State, Trajectory};

use crate::differences::ratio;

/// Largest ratios of the means of velocity, acceleration and jerk over `window_s` to their limits.
///
/// A mean is the change of the next lower derivative over the window. Windows start, end and have their
/// middles at nodes and halfway between them: means are largest about there. Where motions meet within
/// a window, the larger limit counts.
#[must_use]
pub fn mean_ratios(trajectory: &Trajectory, window_s: f64) -> [f64; 3] {
    let limits = trajectory.path().limits();
    let mut worst = [0.0_f64; 3];
    let mut window = |start: &State, end: &State| {
        let motions = &limits[start.motion.index()..=end.motion.index()];
        let largest = |of: fn(&MotionLimits) -> &Joints| -> Joints {
            std::array::from_fn(|j| motions.iter().map(|limits| of(limits)[j]).fold(0.0, f64::max))
        };
        // Late in a long program, times are rounded. Windows that are cut short at its start or its end
        // show rounding, not means.
        let seconds = end.t_s - start.t_s;
        if seconds < 0.5 * window_s {
            return;
        }
        let mean =
            |from: &Joints, to: &Joints| std::array::from_fn(|j| (to[j] - from[j]) / seconds);
        let found = [
            ratio(&mean(&start.q, &end.q), &largest(|limits| &limits.velocity_rad_s)),
            ratio(&mean(&start.dq, &end.dq), &largest(|limits| &limits.acceleration_rad_s2)),
            ratio(&mean(&start.ddq, &end.ddq), &largest(|limits| &limits.jerk_rad_s3)),
        ];
        for (worst, found) in worst.iter_mut().zip(found) {
            *worst = worst.max(found);
        }
    };
    let end_s = trajectory.cycle_time_s();
    for section in trajectory.sections() {
        for piece in section.pieces() {
            for pair in section.nodes(piece).windows(2) {
                let [from, to] = [pair[0].t_s, pair[1].t_s].map(|t_s| section.start_s() + t_s);
                for t_s in [from, f64::midpoint(from, to)] {
                    let at = |t_s: f64| trajectory.at(t_s.max(0.0).min(end_s));
                    let [before, here, after] = [at(t_s - window_s), at(t_s), at(t_s + window_s)];
                    window(&before, &here);
                    window(&here, &after);
                    window(&at(t_s - 0.5 * window_s), &at(t_s + 0.5 * window_s));
                }
            }
        }
    }
    worst
}
