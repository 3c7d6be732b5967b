//! How near a plan comes to a scene.

use iiwa_log::ClearanceRecord;
use iiwa_scene::{ArmInScene, PlannedClearance};
use iiwa_traj::Section;

/// Least clearance in a section.
pub(crate) fn nearest(arm: &ArmInScene, section: &Section) -> Option<ClearanceRecord> {
    let PlannedClearance { clearance, at_s, .. } = arm.clearance_of_section(section)?;
    Some(ClearanceRecord {
        distance_mm: 1e3 * clearance.distance_m,
        link: clearance.link,
        obstacle: arm.scene().obstacles()[clearance.obstacle].name.clone(),
        at_s,
    })
}
