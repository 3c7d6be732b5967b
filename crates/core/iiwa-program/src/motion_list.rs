//! Motion lists without a start.

use iiwa_kin::Joints;

use crate::{
    program::{Motion, Program, Start},
    source::Sources,
    workcell::Workcell,
};

/// Motions, with the tools, bases and frames that they use: a program without its start, to be run
/// from the robot's current position.
///
/// ```
/// use iiwa_program::{Motion, MotionList, Program, Ptp};
///
/// let list = MotionList::from(vec![Motion::Ptp(Ptp::to([0.3; 7]))]);
/// assert_eq!(
///     list.clone().starting_at([0.0; 7]),
///     Program::from_deg([0.0; 7]).ptp_rad([0.3; 7]).build()
/// );
/// let text = r#"{"motions": [
///     {"type": "ptp", "joints_rad": [0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3]}
/// ]}"#;
/// assert_eq!(MotionList::from_json(text)?, list);
/// # Ok::<(), iiwa_program::ProgramError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MotionList {
    /// Motions in order.
    pub motions: Vec<Motion>,
    /// Tools, bases and frames named by the motions.
    pub workcell: Workcell,
    /// Known sources and labels of the motions.
    pub sources: Sources,
}

impl MotionList {
    /// Program of these motions for the default robot, starting at these joint positions, in rad.
    #[must_use]
    pub fn starting_at(self, start_rad: Joints) -> Program {
        let Self { motions, workcell, sources } = self;
        Program { robot: None, start: Start::Joints(start_rad), motions, workcell, sources }
    }

    /// The motions without sources, labels and shapes of loads: robot programs do not use them, and
    /// refuse unknown keys. Repeat blocks are written out.
    #[must_use]
    pub fn for_robot_program(self) -> Self {
        let Self { mut motions, mut workcell, .. } = self;
        let of_tools = workcell.tools.values_mut().filter_map(|tool| tool.load.as_mut());
        let changed = motions.iter_mut().filter_map(|entry| match entry {
            Motion::Load(load) => load.as_mut(),
            _ => None,
        });
        of_tools.chain(changed).for_each(|load| load.shapes.clear());
        Self { motions, workcell, sources: Sources::default() }
    }
}

/// Keeps the motions of a program and drops its start and robot.
impl From<Program> for MotionList {
    fn from(Program { motions, workcell, sources, .. }: Program) -> Self {
        Self { motions, workcell, sources }
    }
}

/// Creates a list of motions that name no tool, base or frame.
impl From<Vec<Motion>> for MotionList {
    fn from(motions: Vec<Motion>) -> Self {
        Self { motions, workcell: Workcell::default(), sources: Sources::default() }
    }
}
