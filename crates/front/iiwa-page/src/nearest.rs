//! How near the arm is to an obstacle or to itself, for pages.

use iiwa_kin::part_name;
use iiwa_scene::{ArmInScene, Clearance};
use serde::Serialize;

/// Where the arm is nearest to an obstacle, or to itself.
#[derive(Clone, Debug, Serialize)]
pub struct Nearest {
    /// Distance in mm; 0 if they touch.
    pub distance_mm: f64,
    /// The arm's link, 2 to 7, or 8 for the tool.
    pub link: usize,
    /// The name of the obstacle, or of another link of the arm.
    pub other: String,
    /// The nearest point of the link, in m.
    pub on_link_m: [f64; 3],
    /// The nearest point of the other, in m.
    pub on_other_m: [f64; 3],
    /// When, in a plan, in s.
    pub at_s: Option<f64>,
}

impl Nearest {
    /// Of a `clearance` of `arm` in its scene, at a time in a plan.
    #[must_use]
    pub fn new(arm: &ArmInScene, clearance: &Clearance, at_s: Option<f64>) -> Self {
        Self {
            distance_mm: 1e3 * clearance.distance_m,
            link: clearance.link,
            other: arm.name_of(clearance.other),
            on_link_m: clearance.on_link_m,
            on_other_m: clearance.on_other_m,
            at_s,
        }
    }

    /// Why this is too near, with at least `min_mm` of clearance required, if it is. Touching always is.
    #[must_use]
    pub fn too_near(&self, min_mm: f64) -> Option<String> {
        let Self { distance_mm, link, other, at_s, .. } = self;
        let part = part_name(*link);
        let when = at_s.map(|at_s| format!(" at {at_s:.2} s")).unwrap_or_default();
        if *distance_mm == 0.0 {
            Some(format!("{part} touches {other}{when}"))
        } else if *distance_mm < min_mm {
            Some(format!(
                "{part} comes within {distance_mm:.1} mm of {other}{when}; the minimum is {min_mm} mm"
            ))
        } else {
            None
        }
    }
}

/// Where the arm is nearest to the obstacles of its scene, and to itself.
#[derive(Clone, Debug, Default, Serialize)]
pub struct NearestPlaces {
    /// None without obstacles.
    #[serde(rename = "nearest")]
    pub to_scene: Option<Nearest>,
    /// None if it is unknown.
    #[serde(rename = "self_nearest")]
    pub to_itself: Option<Nearest>,
}

impl NearestPlaces {
    /// Why the arm is too near to the scene, as [`Nearest::too_near`] says, or touches itself.
    #[must_use]
    pub fn too_near(&self, min_mm: f64) -> Option<String> {
        let to_scene = self.to_scene.as_ref().and_then(|it| it.too_near(min_mm));
        to_scene.or_else(|| self.to_itself.as_ref()?.too_near(0.0))
    }
}
