//! Clearance of the arm to obstacles and to itself, for pages.

use iiwa_kin::part_name;
use iiwa_scene::{ArmInScene, Clearance};
use serde::Serialize;

/// Smallest clearance of the arm to an obstacle, or to itself.
#[derive(Clone, Debug, Serialize)]
pub struct Nearest {
    /// Distance in mm; 0 for contact.
    pub distance_mm: f64,
    /// Link of the arm, 2 to 7, 8 for the tool, or 9 for the workpiece.
    pub link: usize,
    /// Name of the obstacle, or of another link of the arm.
    pub other: String,
    /// Nearest point of the link, in m.
    pub on_link_m: [f64; 3],
    /// Nearest point of the other body, in m.
    pub on_other_m: [f64; 3],
    /// Time in a plan, in s.
    pub at_s: Option<f64>,
}

impl Nearest {
    /// Converts a `clearance` of `arm` in its scene, at a time in a plan.
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

    /// Describes the violation if the clearance is below `min_mm`, or zero.
    #[must_use]
    pub fn too_near(&self, min_mm: f64) -> Option<String> {
        let Self { distance_mm, link, other, at_s, .. } = self;
        let part = part_name(*link);
        let when = at_s.map(|at_s| format!(" at {at_s:.2} s")).unwrap_or_default();
        if *distance_mm == 0.0 {
            Some(format!("{part} touches {other}{when}"))
        } else if *distance_mm < min_mm {
            Some(format!(
                "{part} comes within {distance_mm:.1} mm of {other}{when}; the minimum is {min_mm} \
                 mm"
            ))
        } else {
            None
        }
    }
}

/// Smallest clearances of the arm to the obstacles of its scene, and to itself.
#[derive(Clone, Debug, Default, Serialize)]
pub struct NearestPlaces {
    /// `None` without obstacles.
    #[serde(rename = "nearest")]
    pub to_scene: Option<Nearest>,
    /// `None` if unknown.
    #[serde(rename = "self_nearest")]
    pub to_itself: Option<Nearest>,
}

impl NearestPlaces {
    /// Describes the violation if the clearance to the scene is too small, see
    /// [`Nearest::too_near`], or the arm touches itself.
    #[must_use]
    pub fn too_near(&self, min_mm: f64) -> Option<String> {
        let to_scene = self.to_scene.as_ref().and_then(|it| it.too_near(min_mm));
        to_scene.or_else(|| self.to_itself.as_ref()?.too_near(0.0))
    }
}
