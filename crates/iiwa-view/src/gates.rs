//! Gates of a plan: how long it may take, how near the arm may come to obstacles.

use iiwa_log::{ClearanceRecord, PlanFigures, SelfClearanceRecord};
use iiwa_scene::part_name;

use crate::printable;

/// What a plan may take at most, and how near the arm may come to obstacles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanGates {
    /// Longest cycle time, in s.
    pub max_cycle_time_s: Option<f64>,
    /// Smallest clearance, in mm. An arm that touches an obstacle or itself does not meet any.
    pub min_clearance_mm: Option<f64>,
}

/// Which gates a plan does not meet, and how.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnmetGates {
    /// How it takes too long.
    pub too_long: Option<String>,
    /// How the arm comes too near to an obstacle, or touches itself.
    pub too_near: Option<String>,
}

impl PlanGates {
    /// Judges a plan by its figures.
    #[must_use]
    pub fn judge(&self, figures: &PlanFigures) -> UnmetGates {
        let cycle_time_s = figures.cycle_time_s;
        let too_long = self
            .max_cycle_time_s
            .filter(|limit| cycle_time_s > *limit)
            .map(|limit| format!("takes {cycle_time_s:.3} s, more than {limit} s"));
        let too_near = self.min_clearance_mm.and_then(|limit_mm| {
            let scene = figures.clearance.as_ref().and_then(|it| too_near(limit_mm, it));
            scene.or_else(|| figures.self_clearance.as_ref().and_then(touches_itself))
        });
        UnmetGates { too_long, too_near }
    }
}

impl UnmetGates {
    /// All that is not met, if anything.
    #[must_use]
    pub fn complaint(&self) -> Option<String> {
        match (&self.too_long, &self.too_near) {
            (Some(long), Some(near)) => Some(format!("{long}, and {near}")),
            (long, near) => long.as_ref().or(near.as_ref()).cloned(),
        }
    }
}

/// How the arm comes too near to an obstacle, if it does. What touches is too near for any gate.
fn too_near(limit_mm: f64, nearest: &ClearanceRecord) -> Option<String> {
    let ClearanceRecord { distance_mm, link, obstacle, at_s } = nearest;
    let obstacle = printable(obstacle);
    let place = format!("{} at {at_s:.3} s", part_name(*link));
    if *distance_mm == 0.0 {
        Some(format!("touches {obstacle}: {place}"))
    } else if *distance_mm < limit_mm {
        Some(format!(
            "comes within {distance_mm:.1} mm of {obstacle}, less than {limit_mm} mm: {place}"
        ))
    } else {
        None
    }
}

/// How the arm touches itself, if it does. Its links are always near each other: no other distance of theirs is a fault.
fn touches_itself(nearest: &SelfClearanceRecord) -> Option<String> {
    let SelfClearanceRecord { distance_mm, link, other_link, at_s } = nearest;
    let [part, other] = [*link, *other_link].map(part_name);
    (*distance_mm == 0.0).then(|| format!("touches itself: {part} and {other} at {at_s:.3} s"))
}
