//! The reference programs, in `fixtures/reference/programs.json`.

use iiwa_kin::{Joints, Robot};
use iiwa_path::BlendSearch;
use iiwa_program::{Blend, Motion, Program};
use serde_json::Value;

use super::Result;

const PROGRAMS: &str = include_str!("../../fixtures/reference/programs.json");

/// All reference programs, with the results that go with them, in order.
fn cases() -> Result<Vec<Value>> {
    let mut file: Value = serde_json::from_str(PROGRAMS)?;
    match file["cases"].take() {
        Value::Array(cases) => Ok(cases),
        _ => Err("the reference programs have no cases".into()),
    }
}

/// The texts of all reference programs, in order. The first has ten motions over a wide space, all
/// of them blended by a quarter of their segments.
///
/// # Errors
///
/// If the file is not as expected.
pub fn texts() -> Result<Vec<String>> {
    Ok(cases()?.iter().map(|case| case["program"].to_string()).collect())
}

/// The text of the first reference program.
///
/// # Errors
///
/// If there is none.
pub fn ten_motions() -> Result<String> {
    Ok(texts()?.swap_remove(0))
}

/// How long the first reference program is in motion under limits of velocity, acceleration and
/// jerk, in s: by an independent solver, good to 0.1 % from below.
///
/// # Errors
///
/// If there is none.
pub fn ten_motions_jerk_s() -> Result<f64> {
    let cases = cases()?;
    let time = cases.first().and_then(|case| case["motion_s"]["jerk"].as_f64());
    time.ok_or_else(|| "the first reference program has no time under limits of jerk".into())
}

/// One search for the place where a blend starts or ends.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    /// The target that is blended away, in rad.
    pub point_rad: Joints,
    /// The other end of the segment before or after it, in rad.
    pub other_end_rad: Joints,
    /// Radius of the blend, in m.
    pub radius_m: f64,
}

impl Search {
    /// The crossing that `search` finds, as a share of the segment; none if it finds none.
    #[must_use]
    pub fn run(&self, search: BlendSearch, robot: &Robot) -> Option<f64> {
        search.crossing(robot, &[0.0; 3], &self.point_rad, &self.other_end_rad, self.radius_m)
    }
}

/// Both searches of each blend with a radius in the reference programs.
///
/// # Errors
///
/// If the programs cannot be read.
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
