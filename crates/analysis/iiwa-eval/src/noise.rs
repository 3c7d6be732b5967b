//! Noise of a recording.

use iiwa_kin::{Joints, vector::norm};
use iiwa_log::JointLog;

use crate::quantile::{median, quantile};

/// Number of evaluated samples.
const SAMPLES: usize = 20_000;

/// Step in rad below which differences are rounding of the last digits.
const MIN_STEP_RAD: f64 = 1e-9;

/// Returns the standard deviation of rounded positions, in rad. At rest such positions seem to have
/// no noise; in motion they change in steps, the smallest of which is the resolution.
fn rounding_rad(log: &JointLog, joint: usize, stride: usize) -> f64 {
    let steps =
        log.q_rad.windows(2).step_by(stride).map(|pair| (pair[1][joint] - pair[0][joint]).abs());
    let min_step = steps.filter(|step| *step > MIN_STEP_RAD).fold(f64::INFINITY, f64::min);
    if min_step.is_finite() { min_step / 12.0_f64.sqrt() } else { 0.0 }
}

/// Properties of a recording that are known before it is compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RecordingNoise {
    /// Standard deviation of each joint's position, in rad.
    pub(crate) joints_rad: Joints,
    /// Typical time between two samples, in s.
    pub(crate) step_s: f64,
}

impl RecordingNoise {
    /// Estimates the noise from third differences, which contain noise and jerk: at rest, at
    /// constant speed and at constant acceleration they contain only noise, so that a low quantile
    /// of them is evaluated.
    pub(crate) fn of(log: &JointLog) -> Self {
        let count = log.t_s.len();
        let stride = (count / SAMPLES).max(1);
        let mut steps: Vec<f64> =
            (1..count).step_by(stride).map(|i| log.t_s[i] - log.t_s[i - 1]).collect();
        let step_s = median(&mut steps);
        let even = |i: &usize| {
            (1..4).all(|k| (log.t_s[i + k] - log.t_s[i + k - 1] - step_s).abs() < 0.2 * step_s)
        };
        let starts: Vec<usize> =
            (0..count.saturating_sub(3)).step_by(stride).filter(even).collect();
        let joints_rad = std::array::from_fn(|j| {
            let difference = |i: &usize| {
                let q = |k: usize| log.q_rad[i + k][j];
                (q(3) - 3.0 * q(2) + 3.0 * q(1) - q(0)).abs()
            };
            let mut differences: Vec<f64> = starts.iter().map(difference).collect();
            // A quarter of a normal distribution is within 0.3186 standard deviations; the standard
            // deviation of third differences is sqrt(1 + 9 + 9 + 1) times that of the samples.
            let noise_rad = quantile(&mut differences, 0.25) / (0.3186 * 20.0_f64.sqrt());
            if noise_rad > MIN_STEP_RAD { noise_rad } else { rounding_rad(log, j, stride) }
        });
        Self { joints_rad, step_s }
    }

    /// Returns the noise of all joints together, in rad.
    pub(crate) fn norm_rad(&self) -> f64 {
        norm(&self.joints_rad)
    }

    /// Returns the standard deviation along a direction, in rad.
    pub(crate) fn along_rad(&self, unit: &Joints) -> f64 {
        norm(&std::array::from_fn(|j| unit[j] * self.joints_rad[j]))
    }

    /// Returns the time between samples from which it counts as a gap, in s.
    pub(crate) fn gap_s(&self) -> f64 {
        (5.0 * self.step_s).max(0.02)
    }
}
