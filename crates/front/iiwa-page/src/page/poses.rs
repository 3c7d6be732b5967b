//! Where an arm is, over time.

use iiwa_kin::Joints;
use serde::Serialize;

use crate::arm_look::Packed;

/// Poses of an arm at most: an hour has ten a second, and the arm moves evenly in between.
const POSES: usize = 36_000;

/// Where the arm is, now and then.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Poses {
    count: usize,
    /// Doubles.
    t_s: Packed,
    /// Singles: seven a pose.
    q_rad: Packed,
}

impl Poses {
    /// Poses at some times, with gaps that are left out, all later by `shift_s`.
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
