//! Velocity, acceleration, position and jumps of the set-points on the wire.

use iiwa_kin::{Joints, Limits};

use super::cell::{Cell, SentSetpoint};

impl Cell {
    /// Returns the largest velocity, acceleration and jump, each as a share of its bound, and the
    /// number of restarts at the robot position.
    pub(super) fn judge(&self) -> ([f64; 3], u32) {
        let Limits { velocity_rad_s, acceleration_rad_s2, upper_rad, .. } = self.limits;
        let step_s = f64::from(self.config.receive_multiplier) * self.period_s();
        let away = velocity_rad_s.map(|speed| speed * (0.03 + 3.0 * step_s));
        let (mut worst, mut restarts) = ([0.0_f64; 3], 0);
        let Some(first) = self.wire.first() else { return (worst, 0) };
        let mut before =
            History { t_s: first.t_s - step_s, at_rad: first.arm_rad, ..History::default() };
        before.step_s = step_s;
        for answer in &self.wire {
            let share = |history: &History| {
                let (now, acceleration) = history.derivatives(answer);
                let max_share = |derivatives: Joints, limits: Joints| {
                    (0..7).map(|j| derivatives[j].abs() / limits[j]).fold(0.0, f64::max)
                };
                [max_share(now, velocity_rad_s), max_share(acceleration, acceleration_rad_s2)]
            };
            let mut derivatives = share(&before);
            let mut next = before.next(answer);
            if let Some(speed) = answer.restart_speed {
                let restarted =
                    History { t_s: answer.t_s - step_s, at_rad: answer.arm_rad, speed, step_s };
                if derivatives[0] > 1.02 || derivatives[1] > 1.3 {
                    restarts += 1;
                    (derivatives, next) = (share(&restarted), restarted.next(answer));
                }
            }
            let jump = (0..7).map(|j| (answer.at_rad[j] - answer.arm_rad[j]).abs() / away[j]);
            let derivatives = [derivatives[0], derivatives[1], jump.fold(0.0, f64::max)];
            worst = std::array::from_fn(|i| worst[i].max(derivatives[i]));
            for j in 0..7 {
                assert!(answer.at_rad[j].abs() <= upper_rad[j] + 1e-9, "joint {}", j + 1);
            }
            before = next;
        }
        (worst, restarts)
    }
}

/// State of the set-points up to an answer.
#[derive(Default)]
pub(super) struct History {
    pub(super) t_s: f64,
    pub(super) at_rad: Joints,
    /// Velocity since the previous answer, and the time since then.
    pub(super) speed: Joints,
    pub(super) step_s: f64,
}

impl History {
    /// Returns velocity and acceleration up to the next answer.
    pub(super) fn derivatives(&self, next: &SentSetpoint) -> (Joints, Joints) {
        let step_s = next.t_s - self.t_s;
        let speed: Joints = std::array::from_fn(|j| (next.at_rad[j] - self.at_rad[j]) / step_s);
        let span_s = 0.5 * (step_s + self.step_s);
        (speed, std::array::from_fn(|j| (speed[j] - self.speed[j]) / span_s))
    }

    pub(super) fn next(&self, next: &SentSetpoint) -> Self {
        let (speed, _) = self.derivatives(next);
        Self { t_s: next.t_s, at_rad: next.at_rad, speed, step_s: next.t_s - self.t_s }
    }
}
