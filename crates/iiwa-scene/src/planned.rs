//! The clearance of a planned motion.

use iiwa_traj::Trajectory;
use serde::Serialize;

use crate::clearance::{ArmInScene, Clearance};

/// The smallest clearance of a planned motion, and when it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlannedClearance {
    /// How near the arm comes, and to what.
    pub clearance: Clearance,
    /// When, in s from the start of the program.
    pub at_s: f64,
    /// In which motion of the program, from 0.
    pub motion: usize,
}

impl ArmInScene {
    /// The smallest clearance of `trajectory`; none if the scene has no obstacles.
    #[must_use]
    pub fn clearance_of(&self, trajectory: &Trajectory) -> Option<PlannedClearance> {
        let at = |state: iiwa_traj::State| {
            let clearance = self.clearance(&state.q)?;
            Some(PlannedClearance { clearance, at_s: state.t_s, motion: state.motion })
        };
        let steps = (trajectory.cycle_time_s() / 1e-3).ceil() as usize;
        (0..=steps)
            .filter_map(|step| at(trajectory.at(step as f64 * 1e-3)))
            .min_by(|a, b| a.clearance.distance_m.total_cmp(&b.clearance.distance_m))
    }
}
