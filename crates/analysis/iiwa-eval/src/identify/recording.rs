//! Input of identification.

use iiwa_log::JointLog;
use iiwa_program::Program;

/// Program with the recording of its execution.
#[derive(Clone, Copy, Debug)]
pub struct RecordedRun<'a> {
    /// Program.
    pub program: &'a Program,
    /// Recording; before and after the program the robot may be at rest or perform other motions.
    pub log: &'a JointLog,
}
