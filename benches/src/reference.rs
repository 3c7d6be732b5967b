//! Reference programs in `fixtures/reference/programs.json`.

use iiwa_kin::{Joints, Robot};
use iiwa_path::BlendSearch;
use iiwa_program::{Blend, Motion, Program};
use serde_json::Value;

use super::Result;

const PROGRAMS: &str = include_str!("../../fixtures/reference/programs.json");

/// Returns all reference programs with their results, in order.
fn cases() -> Result<Vec<Value>> {
    let mut file: Value = serde_json::from_str(PROGRAMS)?;
    match file["cases"].take() {
        Value::Array(cases) => Ok(cases),
        _ => Err("the reference programs have no cases".into()),
    }
}

/// Returns the texts of all reference programs, in order. The first has ten motions over a wide
/// space, all of them blended by a quarter of their segments.
///
/// # Errors
///
/// An error if the file is not as expected.
pub fn texts() -> Result<Vec<String>> {
    Ok(cases()?.iter().map(|case| case["program"].to_string()).collect())
}

/// Returns the text of the first reference program.
///
/// # Errors
///
/// An error if the file is not as expected.
pub fn ten_motions() -> Result<String> {
    Ok(texts()?.swap_remove(0))
}

/// Returns the time in motion of the first reference program with velocity, acceleration and jerk
/// limits, in s: from an independent solver, accurate to 0.1 % from below.
///
/// # Errors
///
/// An error if the time is missing.
pub fn ten_motions_jerk_s() -> Result<f64> {
    let cases = cases()?;
    let time = cases.first().and_then(|case| case["motion_s"]["jerk"].as_f64());
    time.ok_or_else(|| "the first reference program has no time under jerk limits".into())
}

/// Search for the start or the end of a blend.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    /// Blended target, in rad.
    pub point_rad: Joints,
    /// Other end of the segment before or after the target, in rad.
    pub other_end_rad: Joints,
    /// Radius of the blend, in m.
    pub radius_m: f64,
}

impl Search {
    /// Returns the crossing that `search` finds, relative to the segment; `None` if it finds none.
    #[must_use]
    pub fn run(&self, search: BlendSearch, robot: &Robot) -> Option<f64> {
        search.crossing(robot, &[0.0; 3], &self.point_rad, &self.other_end_rad, self.radius_m)
    }
}

/// Returns both searches of each blend with a radius in the reference programs.
///
/// # Errors
///
/// An error if the programs cannot be read.
pub fn searches() -> Result<Vec<Search>> {
    let mut searches = Vec::new();
    for text in texts()? {
        let program = Program::from_json(&text)?;
        let targets: Vec<_> = program
            .motions
            .iter()
            .filter_map(|motion| match motion {
                Motion::Ptp(ptp) => Some(ptp),
                _ => None,
            })
            .collect();
        let mut before = *program.start.joints_rad().ok_or("the start is a frame")?;
        for (i, ptp) in targets.iter().enumerate() {
            let point_rad = ptp.target_rad;
            if let (Some(Blend::CartMm(radius_mm)), Some(next)) = (ptp.blend, targets.get(i + 1)) {
                searches.extend([before, next.target_rad].map(|other_end_rad| Search {
                    point_rad,
                    other_end_rad,
                    radius_m: radius_mm * 1e-3,
                }));
            }
            before = point_rad;
        }
    }
    Ok(searches)
}
