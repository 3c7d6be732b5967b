//! Program of an experiment.

use iiwa_kin::Joints;
use iiwa_program::{Motion, Program, Ptp, Sources, Start, Workcell};

/// Program of an experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Name, of letters, digits and `-`.
    pub name: String,
    /// Program.
    pub program: Program,
}

/// Creates a program of PTP motions from a start, in rad.
pub(super) fn program(start_rad: Joints, motions: impl IntoIterator<Item = Ptp>) -> Program {
    Program {
        robot: None,
        start: Start::Joints(start_rad),
        motions: motions.into_iter().map(Motion::Ptp).collect(),
        workcell: Workcell::default(),
        sources: Sources::default(),
    }
}
