//! Parts of a program.

use iiwa_program::{Motion, Program, Sources, Start};

/// Returns a program of these entries, with the robot and the workcell of `program`.
pub(crate) fn part(program: &Program, start: Start, motions: Vec<Motion>) -> Program {
    Program {
        robot: program.robot.clone(),
        start,
        motions,
        workcell: program.workcell.clone(),
        sources: Sources::default(),
    }
}
