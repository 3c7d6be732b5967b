//! Measured joint positions: delayed, with a vibration while a joint moves, and with noise.
//!
//! Source of the constants: a log of a real LBR iiwa 7 R800 at 1 kHz (docs/evidence.md). Its
//! measured positions lag the commanded ones by 2.4 to 2.5 ms in all joints. During motion, the
//! measured positions vibrate by 3e-6 to 1e-5 rad (standard deviation), mostly below 40 Hz. Slower
//! deviations and the offset at rest, up to 2e-4 rad, are not modelled.

use std::{collections::VecDeque, f64::consts::TAU};

use iiwa_kin::Joints;

use crate::noise::Noise;

/// Lag of measured positions of a real robot, in s.
pub(crate) const LAG_S: f64 = 0.0024;

/// Maximum lag of measured positions, in s.
const MAX_LAG_S: f64 = 1.0;

/// Standard deviation of the vibration of a moving joint of a real robot, in rad.
pub(crate) const VIBRATION_RAD: f64 = 6e-6;

/// Frequency of the vibration, in Hz.
const VIBRATION_HZ: f64 = 20.0;

/// Time constant of the vibration decay, in s.
const DECAY_S: f64 = 0.1;

/// Amplitude below which a joint counts as at rest, in rad.
const REST_RAD: f64 = 1e-9;

/// Number of interpolation points of a polynomial.
const POINTS: usize = 4;

const NOISE_SEED: u64 = 1;
const VIBRATION_SEED: u64 = 2;

/// Joint position sensors.
#[derive(Clone, Debug)]
pub(crate) struct PositionSensors {
    /// Lag in cycles.
    lag: f64,
    /// Commanded positions of the last cycles, in rad, the latest first.
    trail: VecDeque<Joints>,
    vibration: Vibration,
    noise: Noise,
}

impl PositionSensors {
    /// Creates sensors that report the commanded positions.
    pub(crate) fn ideal() -> Self {
        Self::new(1.0, 0.0, 0.0, 0.0)
    }

    /// Creates sensors that are read every `period_s`. Vibration and noise are standard deviations
    /// in rad.
    pub(crate) fn new(period_s: f64, lag_s: f64, vibration_rad: f64, noise_rad: f64) -> Self {
        Self {
            lag: lag_s.clamp(0.0, MAX_LAG_S) / period_s,
            trail: VecDeque::new(),
            vibration: Vibration::new(period_s, vibration_rad),
            noise: Noise::new(noise_rad, NOISE_SEED),
        }
    }

    /// Returns the measured positions in rad, one cycle after the previous ones.
    pub(crate) fn read(&mut self, commanded_rad: &Joints) -> Joints {
        let before = self.trail.front().unwrap_or(commanded_rad);
        let moves = std::array::from_fn(|j| before[j] != commanded_rad[j]);
        self.trail.push_front(*commanded_rad);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small counts")]
        let whole = self.lag.floor() as usize;
        // The delayed time is between the second and the third interpolation point, if the lag is
        // long enough.
        let first = whole.saturating_sub(1);
        self.trail.truncate(first + POINTS);
        let late = self.between(first);
        let vibration = self.vibration.advance(moves);
        std::array::from_fn(|j| late[j] + vibration[j] + self.noise.next())
    }

    /// Returns the commanded positions at the lag, on the polynomial through the positions from
    /// `first` on.
    fn between(&self, first: usize) -> Joints {
        let now = self.trail[0];
        if self.lag == 0.0 {
            return now;
        }
        // Before the first cycle, the robot was at rest.
        let oldest = self.trail[self.trail.len() - 1];
        let fraction = self.lag - first as f64;
        let mut late = now;
        for point in 0..POINTS {
            let weight = (0..POINTS)
                .filter(|other| *other != point)
                .map(|other| (fraction - other as f64) / (point as f64 - other as f64))
                .product::<f64>();
            let position = self.trail.get(first + point).unwrap_or(&oldest);
            // Weighted differences instead of positions, so that the result is exact at rest.
            for (late, (position, now)) in late.iter_mut().zip(position.iter().zip(&now)) {
                *late += weight * (position - now);
            }
        }
        late
    }
}

/// Oscillators, one per joint, excited by random forces while the joint moves.
#[derive(Clone, Debug)]
struct Vibration {
    /// Deflection and, a quarter of a period ahead, its rate, in rad.
    state: [[f64; 2]; 7],
    /// Decay factor and rotation angle of one cycle.
    decay: f64,
    turn: f64,
    force: Noise,
}

impl Vibration {
    /// Creates oscillators with a standard deviation of the deflection in rad.
    fn new(period_s: f64, deviation_rad: f64) -> Self {
        let decay = (-period_s / DECAY_S).exp();
        let force = deviation_rad * (1.0 - decay * decay).sqrt();
        Self {
            state: [[0.0; 2]; 7],
            decay,
            turn: TAU * VIBRATION_HZ * period_s,
            force: Noise::new(force, VIBRATION_SEED),
        }
    }

    /// Returns the deflections in rad, one cycle later.
    fn advance(&mut self, moves: [bool; 7]) -> Joints {
        let (sin, cos) = self.turn.sin_cos();
        for (state, moves) in self.state.iter_mut().zip(moves) {
            let [x, y] = *state;
            let turned = [self.decay * (cos * x - sin * y), self.decay * (sin * x + cos * y)];
            *state = if moves {
                turned.map(|value| value + self.force.next())
            } else if turned[0].hypot(turned[1]) < REST_RAD {
                [0.0; 2]
            } else {
                turned
            };
        }
        self.state.map(|[deflection, _]| deflection)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns positions of a joint that accelerates, moves at constant speed from 0.6 s on, and
    /// stops abruptly at 5 s.
    fn motion(t_s: f64) -> Joints {
        let mut q = [0.3; 7];
        q[0] = if t_s < 0.2 {
            0.0
        } else if t_s < 0.6 {
            (t_s - 0.2).powi(2)
        } else {
            0.16 + 0.8 * (t_s.min(5.0) - 0.6)
        };
        q
    }

    fn readings(period_s: f64, mut sensors: PositionSensors, until_s: f64) -> Vec<(f64, Joints)> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
        let cycles = (until_s / period_s) as u32;
        (0..cycles)
            .map(|cycle| f64::from(cycle) * period_s)
            .map(|t_s| (t_s, sensors.read(&motion(t_s))))
            .collect()
    }

    #[test]
    fn measured_positions_lag_and_are_exact_at_rest() {
        for period_s in [0.001, 0.002, 0.005, 0.01] {
            let sensors = PositionSensors::new(period_s, LAG_S, 0.0, 0.0);
            let mut checked = 0;
            for (t_s, measured) in readings(period_s, sensors, 6.0) {
                // Not across the times at which velocity or acceleration are discontinuous.
                let smooth = [0.2, 0.6, 5.0]
                    .iter()
                    .all(|jump| !(-1e-9..3.1 * period_s + LAG_S).contains(&(t_s - jump)));
                if smooth {
                    let off = measured[0] - motion(t_s - LAG_S)[0];
                    assert!(off.abs() < 1e-12, "{off:e} rad at {t_s} s, every {period_s} s");
                    checked += 1;
                }
                assert_eq!(measured[1].to_bits(), 0.3_f64.to_bits());
                if t_s > 5.1 {
                    assert_eq!(measured[0].to_bits(), motion(t_s)[0].to_bits());
                }
            }
            assert!(checked > 400);
        }
    }

    #[test]
    fn moving_joints_vibrate_and_those_at_rest_do_not() {
        for period_s in [0.001, 0.005] {
            let sensors = PositionSensors::new(period_s, 0.0, VIBRATION_RAD, 0.0);
            let read = readings(period_s, sensors.clone(), 8.0);
            assert_eq!(read, readings(period_s, sensors, 8.0));
            let off = |(t_s, measured): &(f64, Joints)| measured[0] - motion(*t_s)[0];
            let while_moving: Vec<f64> =
                read.iter().filter(|(t_s, _)| (1.0..5.0).contains(t_s)).map(off).collect();
            let deviation = (while_moving.iter().map(|off| off * off).sum::<f64>()
                / while_moving.len() as f64)
                .sqrt();
            assert!((3e-6..1e-5).contains(&deviation), "{deviation:e} rad");
            for reading in &read {
                let at_rest = reading.0 < 0.2 || reading.0 > 6.5;
                assert!(!at_rest || off(reading) == 0.0, "{} s", reading.0);
                assert_eq!(reading.1[1].to_bits(), 0.3_f64.to_bits());
            }
        }
    }
}
