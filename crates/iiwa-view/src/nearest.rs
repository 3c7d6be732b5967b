//! How near the arm is to an obstacle, for pages.

use iiwa_scene::{ArmInScene, Clearance, part_name};
use serde::Serialize;

/// Where the arm is nearest to an obstacle.
#[derive(Clone, Debug, Serialize)]
pub struct Nearest {
    /// Distance in mm; 0 if the arm touches the obstacle.
    pub distance_mm: f64,
    /// The arm's link, 2 to 7, or 8 for the tool.
    pub link: usize,
    /// The obstacle's name.
    pub obstacle: String,
    /// The nearest point of the arm, in m.
    pub on_arm_m: [f64; 3],
    /// The nearest point of the obstacle, in m.
    pub on_obstacle_m: [f64; 3],
    /// When, in a plan, in s.
    pub at_s: Option<f64>,
}

impl Nearest {
    /// Of a `clearance` of `arm` in its scene, at a time in a plan.
    #[must_use]
    pub fn new(arm: &ArmInScene, clearance: &Clearance, at_s: Option<f64>) -> Self {
        let obstacles = arm.scene().obstacles();
        Self {
            distance_mm: 1e3 * clearance.distance_m,
            link: clearance.link,
            obstacle: obstacles
                .get(clearance.obstacle)
                .map_or_else(String::new, |it| it.name.clone()),
            on_arm_m: clearance.on_arm_m,
            on_obstacle_m: clearance.on_obstacle_m,
            at_s,
        }
    }

    /// Why this is too near, with at least `min_mm` of clearance required, if it is. Touching always is.
    #[must_use]
    pub fn too_near(&self, min_mm: f64) -> Option<String> {
        let Self { distance_mm, link, obstacle, at_s, .. } = self;
        let part = part_name(*link);
        let when = at_s.map(|at_s| format!(" at {at_s:.2} s")).unwrap_or_default();
        if *distance_mm == 0.0 {
            Some(format!("{part} touches {obstacle}{when}"))
        } else if *distance_mm < min_mm {
            Some(format!(
                "{part} comes within {distance_mm:.1} mm of {obstacle}{when}; the minimum is {min_mm} mm"
            ))
        } else {
            None
        }
    }
}
