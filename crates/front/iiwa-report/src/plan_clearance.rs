//! Clearance of a plan to a scene, and of the arm to itself.

use iiwa_plan::{ClearanceRecord, Error, PlanFigures, ProgramSource, SelfClearanceRecord};
use iiwa_program::ProgramError;
use iiwa_scene::{ArmInScene, CarriedBodies, Other, PlannedClearance};
use iiwa_traj::Section;

/// Returns the shapes that a program carries at the flange, with their meshes.
///
/// # Errors
///
/// [`Error::Program`] if a mesh is unknown or not solid.
pub fn carried(source: &ProgramSource) -> Result<CarriedBodies, Error> {
    CarriedBodies::new(&source.program, |file| source.mesh(file)).map_err(|error| {
        Error::Program(ProgramError::Json {
            message: error.message(),
            motion: error.motion(),
            sources: source.program.sources.clone(),
            place: error.place_in(source.text.as_read()),
        })
    })
}

/// Adds the smallest clearances in a section to the figures.
pub fn add_clearances(figures: &mut PlanFigures, arm: &ArmInScene, section: &Section) {
    let planned = [arm.clearance_of_section(section), arm.self_clearance_of_section(section)];
    for PlannedClearance { clearance, at_s, .. } in planned.into_iter().flatten() {
        let (distance_mm, link) = (1e3 * clearance.distance_m, clearance.link);
        match clearance.other {
            Other::Obstacle(_) => {
                let obstacle = arm.name_of(clearance.other);
                figures.add_clearance(ClearanceRecord { distance_mm, link, obstacle, at_s });
            }
            Other::Link(other_link) => {
                let nearest = SelfClearanceRecord { distance_mm, link, other_link, at_s };
                figures.add_self_clearance(nearest);
            }
        }
    }
}
