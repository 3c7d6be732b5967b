//! Torques and the corresponding motion, over short windows of a recording.

use iiwa_kin::Joints;
use iiwa_log::JointLog;
use nalgebra::{Matrix4, Vector4};

/// Window of a recording.
#[derive(Clone, Copy, Debug)]
pub(super) struct TorqueWindow {
    /// Mean torque.
    pub(super) torque_nm: Joints,
    /// Instants whose weighted sum is the mean of any quantity over the window (Gauss's rule with
    /// three points).
    pub(super) instants: [WindowInstant; 3],
    /// Activity of each joint, if it is the same throughout the window.
    pub(super) does: [Option<JointDoes>; 7],
}

/// Motion state at an instant, and its weight in the mean over a window.
#[derive(Clone, Copy, Debug)]
pub(super) struct WindowInstant {
    pub(super) share: f64,
    pub(super) q_rad: Joints,
    pub(super) velocity_rad_s: Joints,
    pub(super) acceleration_rad_s2: Joints,
}

/// Activity of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JointDoes {
    Stands,
    Moves,
}

impl TorqueWindow {
    pub(super) fn mean_velocity_rad_s(&self, joint: usize) -> f64 {
        self.instants.iter().map(|instant| instant.share * instant.velocity_rad_s[joint]).sum()
    }
}

/// Minimum half-width of a window, in s, and in sampling periods.
const HALF_S: f64 = 0.02;
const HALF_STEPS: f64 = 4.0;

/// Rotation in half a window, in rad, below which a joint is at rest or reverses.
const MOVES_RAD: f64 = 2e-4;

/// Largest displacement of a joint at rest, in rad, plus multiples of the standard deviation of its
/// samples.
const STANDS_RAD: f64 = 1e-5;
const STANDS_DEVIATIONS: f64 = 8.0;

/// Returns the half-width of the windows of a recording, in s.
pub(super) fn half_s(log: &JointLog) -> f64 {
    HALF_S.max(HALF_STEPS * log.period_s().unwrap_or_default())
}

/// Returns adjacent windows, as far as they have samples with torques throughout.
///
/// Accelerations are the second derivatives of cubics (Savitzky and Golay 1964). They are averages
/// of the acceleration over the window, with weights that are 0 at its ends. Recorded torques, and
/// those of the model along the cubics, are averaged with the same weights, so that both sides of
/// the equations of motion are smoothed alike. No sample belongs to two windows: their noise is
/// independent.
pub(super) fn windows(log: &JointLog, exerted_nm: &[Option<Joints>]) -> Vec<TorqueWindow> {
    let count = log.t_s.len().min(exerted_nm.len());
    let Some(period_s) = log.period_s() else { return Vec::new() };
    let half_s = half_s(log);
    let mut windows = Vec::new();
    let mut first = 0;
    while first < count {
        // Stamps are rounded sums.
        let end_s = log.t_s[first] + 2.0 * half_s + 0.01 * period_s;
        let end = first + log.t_s[first..count].partition_point(|t_s| *t_s <= end_s);
        windows.extend(window(log, exerted_nm, first..end, [half_s, period_s]));
        first = end;
    }
    windows
}

fn window(
    log: &JointLog,
    exerted_nm: &[Option<Joints>],
    samples: std::ops::Range<usize>,
    [half_s, period_s]: [f64; 2],
) -> Option<TorqueWindow> {
    let (t_s, q) = (&log.t_s[samples.clone()], &log.q_rad[samples.clone()]);
    let torques: Vec<Joints> = exerted_nm[samples].iter().copied().collect::<Option<_>>()?;
    let (first_s, last_s) = (*t_s.first()?, *t_s.last()?);
    let is_whole = t_s.windows(2).all(|pair| pair[1] - pair[0] <= 2.5 * period_s)
        && last_s - first_s > 1.5 * half_s;
    if t_s.len() < 6 || !is_whole {
        return None;
    }
    let middle_s = f64::midpoint(first_s, last_s);
    let half_s = 0.5 * (last_s - first_s);
    let powers = |t_s: f64| {
        let x = (t_s - middle_s) / half_s;
        Vector4::new(1.0, x, x * x, x * x * x)
    };
    let normal: Matrix4<f64> = t_s.iter().map(|t_s| powers(*t_s) * powers(*t_s).transpose()).sum();
    let inverse = normal.cholesky()?.inverse();
    // Each derivative is a weighted sum of the samples.
    let weights: Vec<Vector4<f64>> = t_s.iter().map(|t_s| inverse * powers(*t_s)).collect();
    // An acceleration at a sample shifts all later ones: its weight in the second derivative.
    let kernel: Vec<f64> = (0..t_s.len())
        .map(|k| (k..t_s.len()).map(|i| weights[i][2] * (t_s[i] - t_s[k])).sum::<f64>().max(0.0))
        .collect();
    let whole: f64 = kernel.iter().sum();
    let mean = |j: usize| -> f64 {
        torques.iter().zip(&kernel).map(|(torque, weight)| torque[j] * weight).sum::<f64>() / whole
    };
    let moment = |power: i32| -> f64 {
        let terms = t_s.iter().zip(&kernel);
        terms.map(|(t_s, weight)| weight * ((t_s - middle_s) / half_s).powi(power)).sum::<f64>()
            / whole
    };
    let (second, fourth) = (moment(2), moment(4));
    let (abscissa, share) = ((fourth / second).sqrt(), 0.5 * second * second / fourth);
    let fitted = |j: usize| -> Vector4<f64> {
        // Relative to the first value, to avoid cancellation.
        q.iter().zip(&weights).map(|(q_i, weight)| weight * (q_i[j] - q[0][j])).sum()
    };
    let cubics: [Vector4<f64>; 7] = std::array::from_fn(fitted);
    let does = std::array::from_fn(|j| {
        let (cubic, base) = (&cubics[j], q[0][j]);
        let residuals = t_s.iter().zip(q).map(|(t_s, q)| q[j] - base - cubic.dot(&powers(*t_s)));
        let deviation = (residuals.map(|residuals| residuals * residuals).sum::<f64>()
            / (t_s.len() - 4) as f64)
            .sqrt();
        let ends = [powers(first_s), powers(middle_s), powers(last_s)]
            .map(|abscissa| cubic.dot(&abscissa));
        let [before, after] = [ends[1] - ends[0], ends[2] - ends[1]];
        let farthest = q.iter().map(|q| (q[j] - base).abs()).fold(0.0, f64::max);
        if before * after > 0.0 && before.abs().min(after.abs()) > MOVES_RAD {
            Some(JointDoes::Moves)
        } else if farthest <= STANDS_RAD + STANDS_DEVIATIONS * deviation {
            Some(JointDoes::Stands)
        } else {
            None
        }
    });
    let instant = |(x, share): (f64, f64)| WindowInstant {
        share,
        q_rad: std::array::from_fn(|j| {
            q[0][j] + cubics[j].dot(&Vector4::new(1.0, x, x * x, x * x * x))
        }),
        velocity_rad_s: cubics.map(|c| (c[1] + x * (2.0 * c[2] + 3.0 * x * c[3])) / half_s),
        acceleration_rad_s2: cubics.map(|c| (2.0 * c[2] + 6.0 * x * c[3]) / half_s.powi(2)),
    };
    Some(TorqueWindow {
        torque_nm: std::array::from_fn(mean),
        instants: [(-abscissa, share), (0.0, 1.0 - 2.0 * share), (abscissa, share)].map(instant),
        does,
    })
}
