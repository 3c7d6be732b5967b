//! Gates of a plan: how long it may take, how near the arm may come to obstacles.

use iiwa_log::{ClearanceRecord, PlanFigures};
use iiwa_view::printable;

use crate::args::Plan;

/// Which gates a program does not meet, and how.
pub(super) struct Gates {
    pub(super) too_long: Option<String>,
    pub(super) too_near: Option<String>,
}

impl Gates {
    pub(super) fn new(options: &Plan, figures: &PlanFigures) -> Self {
        let cycle_time_s = figures.cycle_time_s;
        let too_long = options
            .max_cycle_time
            .filter(|limit| cycle_time_s > *limit)
            .map(|limit| format!("takes {cycle_time_s:.3} s, more than {limit} s"));
        let too_near = options
            .min_clearance
            .zip(figures.clearance.as_ref())
            .and_then(|(limit_mm, nearest)| too_near(limit_mm, nearest));
        Self { too_long, too_near }
    }

    /// All that is not met, if anything.
    pub(super) fn complaint(&self) -> Option<String> {
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
    let place = format!("link {link} at {at_s:.3} s");
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
