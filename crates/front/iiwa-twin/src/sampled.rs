//! Planned trajectories as lists of points for a drive.

use iiwa_link::{MAX_POINTS, TimedJoints};
use iiwa_traj::Trajectory;

/// Time between points of a trajectory, in s.
const STEP_S: f64 = 0.004;

/// Samples a trajectory every 4 ms, and at its end; `None` for more than [`MAX_POINTS`] points.
#[must_use]
pub fn sampled(plan: &Trajectory) -> Option<TimedJoints> {
    let end_s = plan.cycle_time_s();
    let steps = (end_s / STEP_S).ceil();
    if steps >= MAX_POINTS as f64 {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let steps = steps as u32;
    let t_s: Vec<f64> = (0..steps)
        .map(|i| f64::from(i) * STEP_S)
        // Omits a sample immediately before the end.
        .filter(|t_s| end_s - t_s > 1e-3 * STEP_S)
        .chain([end_s])
        .collect();
    let joints_rad = t_s.iter().map(|t_s| plan.at(*t_s).q).collect();
    Some(TimedJoints { t_s, joints_rad })
}
