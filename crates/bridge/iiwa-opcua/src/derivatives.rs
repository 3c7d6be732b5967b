//! Joint speeds and accelerations, which robots do not report, from measured positions.
//!
//! A parabola is fitted to the positions of the last [`WINDOW_S`], by least squares. Its slope at
//! the newest position is the speed, and its curvature the acceleration. Differences of
//! neighbouring positions would multiply the encoder noise by the rate; the parabola averages the
//! noise, has no lag as long as the acceleration is constant, and uses the actual time stamps: lost
//! messages, or another rate, do not affect its correctness. If the jerk is not zero, the
//! acceleration is that of the middle of the window.

use std::collections::VecDeque;

use iiwa_kin::Joints;

/// Length of the window, in s. A joint of an iiwa at its limits takes 0.2 s to its full speed; with
/// 12 positions at 5 ms and a noise of 10 µrad, speeds are within 0.5 mrad/s, and accelerations
/// within 0.04 rad/s² (both one sigma).
const WINDOW_S: f64 = 0.06;
/// Minimum number of positions for a fit: at rates below 100 Hz, the window is longer.
const FEWEST: usize = 6;
/// Maximum number of stored positions. At 1 kHz, the window has 60.
const MOST: usize = 128;
/// Gap in time after which previous positions are discarded, in s.
const LONGEST_GAP_S: f64 = 0.5;

/// Joint speeds and accelerations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointRates {
    /// Speeds in rad/s.
    pub(crate) speed: Joints,
    /// Accelerations in rad/s².
    pub(crate) acceleration: Joints,
}

/// Recent positions.
#[derive(Clone, Debug, Default)]
pub(crate) struct PositionWindow {
    samples: VecDeque<(f64, Joints)>,
}

impl PositionWindow {
    /// Adds positions at a time, in s. A repeated time stamp is ignored; an earlier one, such as
    /// after a restart of the robot clock, or a gap of [`LONGEST_GAP_S`] restarts the window.
    pub(crate) fn push(&mut self, t_s: f64, joints_rad: Joints) {
        if let Some((last_s, _)) = self.samples.back() {
            let gap_s = t_s - last_s;
            if gap_s == 0.0 {
                return;
            }
            if !(gap_s > 0.0 && gap_s < LONGEST_GAP_S) {
                self.samples.clear();
            }
        }
        self.samples.push_back((t_s, joints_rad));
        // One position at the border of the window is kept, so that the window is never shorter
        // than specified.
        while self.samples.len() > FEWEST && self.samples[1].0 <= t_s - WINDOW_S
            || self.samples.len() > MOST
        {
            self.samples.pop_front();
        }
    }

    /// Returns speed and acceleration at the newest position; `None` with too few positions.
    pub(crate) fn derivatives(&self) -> Option<JointRates> {
        let (now_s, newest) = *self.samples.back()?;
        if self.samples.len() < FEWEST {
            return None;
        }
        // Times and positions are relative to the newest ones, because small numbers keep their
        // digits.
        let ages = || self.samples.iter().map(|(t_s, _)| t_s - now_s);
        let moment = |power: i32| ages().map(|t| t.powi(power)).sum::<f64>();
        let (m0, m1, m2, m3, m4) = (moment(0), moment(1), moment(2), moment(3), moment(4));
        // Cofactors of the matrix of the normal equations [m0 m1 m2; m1 m2 m3; m2 m3 m4], which is
        // symmetric.
        let (c01, c02) = (m2 * m3 - m1 * m4, m1 * m3 - m2 * m2);
        let (c11, c12, c22) = (m0 * m4 - m2 * m2, m1 * m2 - m0 * m3, m0 * m2 - m1 * m1);
        let determinant = m0 * (m2 * m4 - m3 * m3) + m1 * c01 + m2 * c02;
        let fit = |joint: usize| {
            let sum = |power: i32| -> f64 {
                let samples = self.samples.iter();
                samples.map(|(t_s, q)| (t_s - now_s).powi(power) * (q[joint] - newest[joint])).sum()
            };
            let (y0, y1, y2) = (sum(0), sum(1), sum(2));
            let slope = (c01 * y0 + c11 * y1 + c12 * y2) / determinant;
            let curvature = (c02 * y0 + c12 * y1 + c22 * y2) / determinant;
            [slope, 2.0 * curvature]
        };
        let fits: [[f64; 2]; 7] = std::array::from_fn(fit);
        let finite = fits.iter().flatten().all(|value| value.is_finite());
        finite.then(|| JointRates {
            speed: fits.map(|[speed, _]| speed),
            acceleration: fits.map(|[_, acceleration]| acceleration),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(times: impl IntoIterator<Item = f64>, q: impl Fn(f64) -> f64) -> Option<JointRates> {
        let mut window = PositionWindow::default();
        for t in times {
            window.push(t, std::array::from_fn(|joint| q(t) * (joint + 1) as f64));
        }
        window.derivatives()
    }

    fn every(step: f64, count: usize) -> impl Iterator<Item = f64> {
        // Hours after the start: the large time must not cost digits.
        (0..count).map(move |i| 20_000.0 + step * i as f64)
    }

    #[test]
    fn constant_acceleration_is_exact_even_if_messages_are_lost() {
        let q = |t: f64| 0.3 - 0.7 * (t - 20_000.0) + 2.0 * (t - 20_000.0).powi(2);
        let samples = every(0.005, 40).enumerate().filter(|(i, _)| i % 7 != 3 && i % 5 != 1);
        let times: Vec<f64> = samples.map(|(_, t)| t).collect();
        let last = times[times.len() - 1] - 20_000.0;
        let actual = of(times, q).unwrap();
        for joint in 0..7 {
            let times = (joint + 1) as f64;
            assert!((actual.speed[joint] - times * (4.0 * last - 0.7)).abs() < 1e-6);
            assert!((actual.acceleration[joint] - times * 4.0).abs() < 1e-4);
        }
    }

    #[test]
    fn motions_at_the_limits_are_followed() {
        // Maxima of 1.7 rad/s and 8.5 rad/s², as for A1 of the LBR iiwa 7.
        let w = 5.0;
        for step in [0.001, 0.005, 0.01] {
            let end = every(step, 400).last().unwrap() - 20_000.0;
            let actual = of(every(step, 400), |t| 0.34 * (w * (t - 20_000.0)).sin()).unwrap();
            let speed = 0.34 * w * (w * end).cos();
            let acceleration = -0.34 * w * w * (w * end).sin();
            assert!((actual.speed[0] - speed).abs() < 0.03, "{} {speed}", actual.speed[0]);
            // Half of a 60 ms window at a jerk of up to 43 rad/s³.
            assert!((actual.acceleration[0] - acceleration).abs() < 1.4);
        }
    }

    #[test]
    fn noise_of_the_encoders_stays_small() {
        let mut seed = 1_u64;
        let mut noise = || {
            // Uniformly distributed with a sigma of 10 µrad.
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((seed >> 33) as f64 / f64::from(1_u32 << 31) - 0.5) * 1e-5 * 12_f64.sqrt()
        };
        let mut window = PositionWindow::default();
        let (mut speeds, mut accelerations, mut count) = (0.0, 0.0, 0.0);
        for t in every(0.005, 4000) {
            window.push(t, std::array::from_fn(|_| noise()));
            if let Some(actual) = window.derivatives() {
                speeds += actual.speed[0].powi(2);
                accelerations += actual.acceleration[0].powi(2);
                count += 1.0;
            }
        }
        let [speed, acceleration] = [speeds, accelerations].map(|sum: f64| (sum / count).sqrt());
        assert!(speed < 0.6e-3, "{speed}");
        assert!(acceleration < 0.04, "{acceleration}");
    }

    #[test]
    fn gaps_and_clocks_that_start_again_begin_anew() {
        assert_eq!(of(every(0.005, 5), |_| 1.0), None);
        let mut window = PositionWindow::default();
        for t in every(0.005, 20) {
            window.push(t, [t - 20_000.0; 7]);
        }
        assert!((window.derivatives().unwrap().speed[6] - 1.0).abs() < 1e-6);
        window.push(3.0, [0.0; 7]);
        assert_eq!(window.derivatives(), None);
        window.push(5.0, [0.0; 7]);
        assert_eq!(window.samples.len(), 1);
        // A repeated message does not add information.
        window.push(5.0, [1.0; 7]);
        assert_eq!(window.samples.len(), 1);
    }
}
