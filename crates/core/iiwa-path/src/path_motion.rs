//! What a path keeps of the motions that it was made of.

use iiwa_kin::Pose;
use iiwa_program::{Fault, Motion, MotionType, Program};

/// A motion as the path knows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PathMotion {
    pub(crate) motion_type: MotionType,
    /// The TCP that it moves, in the flange's frame.
    pub(crate) tcp: Pose,
}

/// The motions of a program in order; none at all if it has neither tools nor frames, so that the many joint motions of
/// a long program take no room.
pub(crate) fn path_motions(program: &Program) -> Result<Vec<PathMotion>, Fault> {
    if program.workcell.tool.is_none() && !program.has_frames() {
        return Ok(Vec::new());
    }
    let types = program.motions.iter().map(Motion::motion_type);
    let tcps = program.tcps()?;
    Ok(types.zip(tcps).map(|(motion_type, tcp)| PathMotion { motion_type, tcp }).collect())
}

/// Whether any motion moves another TCP than the flange.
pub(crate) fn has_tools(motions: &[PathMotion]) -> bool {
    motions.iter().any(|motion| motion.tcp != Pose::IDENTITY)
}
