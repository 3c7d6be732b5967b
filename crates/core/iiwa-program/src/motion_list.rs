//! Motions without a start.

use iiwa_kin::Joints;

use crate::{
    program::{Motion, Program, Start},
    source::Sources,
    workcell::Workcell,
};

/// Motions, and the tools, bases and frames that they use: a program without its start, for an arm to run from where it
/// is.
///
/// ```
/// use iiwa_program::{Motion, MotionList, Program, Ptp};
///
/// let list = MotionList::from(vec![Motion::Ptp(Ptp::to([0.3; 7]))]);
/// assert_eq!(list.clone().starting_at([0.0; 7]), Program::from_deg([0.0; 7]).ptp_rad([0.3; 7]).build());
/// assert_eq!(MotionList::from_json(r#"{"motions": [{"type": "ptp", "joints_rad": [0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3]}]}"#)?, list);
/// # Ok::<(), iiwa_program::ProgramError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MotionList {
    /// What the arm does, in order.
    pub motions: Vec<Motion>,
    /// Tools, bases and frames that the motions name.
    pub workcell: Workcell,
    /// Where they come from, as far as that is known.
    pub sources: Sources,
}

impl MotionList {
    /// The program of these motions, for the default robot, from where the arm has these joints, in rad.
    #[must_use]
    pub fn starting_at(self, start_rad: Joints) -> Program {
        let Self { motions, workcell, sources } = self;
        Program { robot: None, start: Start::Joints(start_rad), motions, workcell, sources }
    }
}

/// What it does, without where it starts and on which robot.
impl From<Program> for MotionList {
    fn from(Program { motions, workcell, sources, .. }: Program) -> Self {
        Self { motions, workcell, sources }
    }
}

/// Motions that use no tool, no base and no frame by its name.
impl From<Vec<Motion>> for MotionList {
    fn from(motions: Vec<Motion>) -> Self {
        Self { motions, workcell: Workcell::default(), sources: Sources::default() }
    }
}
