//! Short runs from the current position of the arm.

use std::time::Duration;

use fastrand::Rng;
use serde_json::{Value, json};

/// Largest distance of targets from the middle of the range, in rad.
const RANGE_RAD: f64 = 0.3;

/// Run to be requested.
pub(super) enum Task {
    /// Motions, planned by the controller.
    Motions(Vec<Value>),
    /// A trajectory: time stamps in s, and positions in rad.
    Trajectory(Vec<f64>, Vec<[f64; 7]>),
}

impl Task {
    /// Returns motions between random targets.
    pub(super) fn motions(random: &mut Rng, count: usize) -> Self {
        let motion = |i: usize| {
            let target: [f64; 7] =
                std::array::from_fn(|_| random.f64() * 2.0 * RANGE_RAD - RANGE_RAD);
            let mut motion = json!({ "type": "ptp", "joints_rad": target, "velocity_rel": 0.5 });
            if i + 1 < count && i.is_multiple_of(2) {
                motion["blend"] = json!({ "fraction": 0.2 });
            }
            motion
        };
        Self::Motions((0..count).map(motion).collect())
    }

    /// Returns a motion of A1 of about this duration, in s.
    pub(super) fn one_motion(from: &[f64; 7], duration_s: f64) -> Self {
        // Half of the velocity limit, without the time to accelerate.
        let mut target = *from;
        target[0] += inward(from[0]) * 0.85 * (duration_s - 0.15).max(0.05);
        Self::Motions(vec![json!({ "type": "ptp", "joints_rad": target, "velocity_rel": 0.5 })])
    }

    /// Returns a minimum-jerk trajectory of A1 of this duration, in s.
    pub(super) fn trajectory(from: &[f64; 7], duration_s: f64) -> Self {
        // Far below the limits: 1.875 times the mean velocity at the middle.
        let distance_rad = inward(from[0]) * 0.04 * duration_s.powi(2).min(4.0);
        let steps = (0_u32..).take_while(|i| f64::from(*i) * 0.004 < duration_s - 0.002);
        let t_s: Vec<_> = steps.map(|i| f64::from(i) * 0.004).chain([duration_s]).collect();
        let position = |t_s: &f64| {
            let s = t_s / duration_s;
            let mut joints = *from;
            joints[0] += distance_rad * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
            joints
        };
        let joints_rad = t_s.iter().map(position).collect();
        Self::Trajectory(t_s, joints_rad)
    }

    /// Returns the request to run the task.
    pub(super) fn request(&self) -> String {
        match self {
            Self::Motions(motions) => json!({ "type": "run_motions", "motions": motions }),
            Self::Trajectory(t_s, joints_rad) => json!({
                "type": "run_trajectory",
                "trajectory": { "t_s": t_s, "joints_rad": joints_rad },
            }),
        }
        .to_string()
    }

    /// Returns the number of motions to be planned.
    pub(super) fn count(&self) -> usize {
        match self {
            Self::Motions(motions) => motions.len(),
            Self::Trajectory(..) => 0,
        }
    }
}

/// Returns a program file.
pub(super) fn program(from: &[f64; 7], motions: &[Value]) -> String {
    json!({ "version": 1, "start": { "joints_rad": from }, "motions": motions }).to_string()
}

/// Returns a program that moves A1 back and forth for about this time.
pub(super) fn there_and_back(from: &[f64; 7], duration: Duration) -> String {
    let mut target = *from;
    target[0] += inward(from[0]) * 0.25;
    // One direction at a tenth of the velocity limit, with acceleration and settle time.
    let legs = (duration.as_millis() / 1600 + 1) as usize;
    let motion = |target| json!({ "type": "ptp", "joints_rad": target, "velocity_rel": 0.1 });
    let motions: Vec<_> = [target, *from].into_iter().cycle().take(legs).map(motion).collect();
    program(from, &motions)
}

/// Returns the direction towards the middle of the range.
fn inward(from_rad: f64) -> f64 {
    if from_rad > 0.0 { -1.0 } else { 1.0 }
}
