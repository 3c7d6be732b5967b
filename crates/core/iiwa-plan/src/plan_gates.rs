//! Gates of a plan: how long it may take, how near the arm may come to obstacles, what its joints may exert.

use iiwa_json::printable;
use iiwa_kin::part_name;

use crate::{ClearanceRecord, LargestTorque, PlanFigures, SelfClearanceRecord};

/// What a plan may take at most, how near the arm may come to obstacles, and what its joints may exert.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanGates {
    /// Longest cycle time, in s.
    pub max_cycle_time_s: Option<f64>,
    /// Smallest clearance, in mm. An arm that touches an obstacle or itself does not meet any.
    pub min_clearance_mm: Option<f64>,
    /// Largest torque of any joint, behind its gear, in per cent of the robot's limit.
    pub max_torque_percent: Option<f64>,
}

/// Which gates a plan does not meet, and how.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnmetGates {
    /// How it takes too long.
    pub too_long: Option<String>,
    /// How the arm comes too near to an obstacle, or touches itself.
    pub too_near: Option<String>,
    /// How a joint exerts too much.
    pub overloaded: Option<String>,
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
        let overloaded = self.max_torque_percent.and_then(|limit| {
            let LargestTorque { motion, joint, percent, at_s, .. } = figures.largest_torque()?;
            (percent > limit).then(|| {
                format!(
                    "needs {percent:.1} % of {joint}'s torque, more than {limit} %: motion {motion} at {at_s:.3} s"
                )
            })
        });
        UnmetGates { too_long, too_near, overloaded }
    }
}

impl UnmetGates {
    /// All that is not met, if anything.
    #[must_use]
    pub fn complaint(&self) -> Option<String> {
        let Self { too_long, too_near, overloaded } = self;
        let unmet: Vec<&str> =
            [too_long, too_near, overloaded].into_iter().flatten().map(String::as_str).collect();
        (!unmet.is_empty()).then(|| unmet.join(", and "))
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
