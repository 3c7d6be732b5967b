//! Poses of an arm over time.

use iiwa_kin::Joints;
use serde::Serialize;

use crate::arm_look::Packed;

/// Maximum number of poses of an arm: ten per second for an hour; pages interpolate linearly.
const POSES: usize = 36_000;

/// Sampled poses of the arm.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Poses {
    count: usize,
    /// Times, as doubles.
    t_s: Packed,
    /// Joint positions, as seven singles per pose.
    q_rad: Packed,
}

impl Poses {
    /// Samples the poses evenly, at most about [`POSES`] of them and always the last one; all times
    /// are shifted by `shift_s`.
    pub(crate) fn new(t_s: &[f64], q_rad: &[Joints], shift_s: f64) -> Self {
        let step = t_s.len().div_ceil(POSES).max(1);
        let last = t_s.len().saturating_sub(1);
        let mut places: Vec<usize> = (0..t_s.len()).step_by(step).collect();
        if places.last() != Some(&last) && !t_s.is_empty() {
            places.push(last);
        }
        Self {
            count: places.len(),
            t_s: Packed::doubles(places.iter().map(|i| t_s[*i] + shift_s)),
            q_rad: Packed::singles(places.iter().flat_map(|i| q_rad[*i])),
        }
    }
}
