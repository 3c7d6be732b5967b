//! Data of the motions of a program that a path keeps.

use iiwa_kin::Pose;
use iiwa_program::{Fault, Motion, MotionType, Program};

/// Type and TCP of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PathMotion {
    pub(crate) motion_type: MotionType,
    /// TCP of the motion in the flange frame.
    pub(crate) tcp: Pose,
}

/// Returns the motions of a program in order. The list is empty if the program has neither tools
/// nor frames, so that the many joint motions of a long program need no memory.
pub(crate) fn path_motions(program: &Program) -> Result<Vec<PathMotion>, Fault> {
    if program.workcell.tool.is_none() && !program.has_frames() {
        return Ok(Vec::new());
    }
    let types = program.motions.iter().map(Motion::motion_type);
    let tcps = program.tcps()?;
    Ok(types.zip(tcps).map(|(motion_type, tcp)| PathMotion { motion_type, tcp }).collect())
}

/// True if any motion moves a TCP other than the flange.
pub(crate) fn has_tools(motions: &[PathMotion]) -> bool {
    motions.iter().any(|motion| motion.tcp != Pose::IDENTITY)
}
