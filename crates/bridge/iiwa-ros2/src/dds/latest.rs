//! Latest sample and state of a robot, for feedback and goal starts.

use std::sync::{Mutex, PoisonError};

use iiwa_kin::Joints;
use iiwa_link::message::DriveState;

/// A stream sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StreamSample {
    /// Controller time, in s.
    pub(super) t_s: f64,
    pub(super) q: Joints,
    /// Mean velocity since the previous sample, in rad/s.
    pub(super) dq: Joints,
}

/// The latest sample, and the start time of the running trajectory, in controller time.
#[derive(Debug, Default)]
pub(super) struct Latest(Mutex<(Option<StreamSample>, Option<f64>)>);

/// Maximum time between samples for which a velocity is computed, in s.
const SLOWEST_S: f64 = 0.2;

impl Latest {
    /// Stores the next positions.
    pub(super) fn sample(&self, t_s: f64, q: Joints) -> StreamSample {
        let (latest, _) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let before = latest.filter(|before| t_s > before.t_s && t_s - before.t_s < SLOWEST_S);
        let dq = before.map_or([0.0; 7], |before| {
            std::array::from_fn(|j| (q[j] - before.q[j]) / (t_s - before.t_s))
        });
        let sample = StreamSample { t_s, q, dq };
        *latest = Some(sample);
        sample
    }

    /// Stores the next drive state.
    pub(super) fn state(&self, t_s: f64, state: DriveState) {
        let (_, running_since) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *running_since = (state == DriveState::RunningTrajectory).then_some(t_s);
    }

    pub(super) fn get(&self) -> (Option<StreamSample>, Option<f64>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_means_between_samples() {
        let latest = Latest::default();
        assert_eq!(latest.sample(1.0, [0.1; 7]).dq, [0.0; 7]);
        assert!((latest.sample(1.01, [0.11; 7]).dq[0] - 1.0).abs() < 1e-9);
        // A restarted controller, and a gap.
        assert_eq!(latest.sample(0.0, [0.2; 7]).dq, [0.0; 7]);
        assert_eq!(latest.sample(5.0, [0.3; 7]).dq, [0.0; 7]);
    }
}
