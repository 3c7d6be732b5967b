//! Parts of a program that changes leave as they are.

use iiwa_kin::{Pose, Robot};
use iiwa_optimise::Optimiser;
use iiwa_plan::PlanOptions;
use iiwa_program::{CartesianMotion, Motion, Program};

/// Returns an optimiser for the robot of a program.
pub(crate) fn optimiser(program: &Program) -> Optimiser {
    let robot = program.robot.as_deref().map_or_else(|| Some(Robot::default()), Robot::built_in);
    Optimiser::new(program.with_flange(robot.unwrap()), PlanOptions::default())
}

/// Pose in the robot base at which a motion ends; `None` for an offset.
pub(crate) fn pose(program: &Program, motion: &CartesianMotion) -> Option<Pose> {
    let target = motion.target()?;
    Some(program.workcell.target(target, motion.base.as_deref()).unwrap().1)
}

/// Checks that frames, speeds of TCP paths, waits, inputs, outputs and the order are the same.
#[track_caller]
pub(crate) fn assert_untouched(program: &Program, changed: &Program) {
    assert_eq!(program.motions.len(), changed.motions.len());
    assert_eq!((&program.start, &program.workcell), (&changed.start, &changed.workcell));
    for (old, new) in program.motions.iter().zip(&changed.motions) {
        match (old, new) {
            (Motion::Ptp(old), Motion::Ptp(new)) => {
                assert_eq!(old.target_rad, new.target_rad);
                assert_eq!(old.acceleration_rel, new.acceleration_rel);
            }
            (Motion::Cartesian(old), Motion::Cartesian(new)) => {
                assert_eq!(old.tool_limits, new.tool_limits);
                assert_eq!((&old.tool, &old.base), (&new.tool, &new.base));
                assert_eq!(old.orientation, new.orientation);
                if !old.is_ptp() {
                    assert_eq!(old.shares, new.shares);
                }
                assert_eq!(pose(program, old), pose(changed, new));
            }
            (old, new) => assert_eq!(old, new),
        }
    }
}
