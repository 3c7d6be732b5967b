//! What is identified from.

use iiwa_log::JointLog;
use iiwa_program::Program;

/// A program, and what the robot did when it ran it.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    /// The program.
    pub program: &'a Program,
    /// What was recorded; before and after the program the arm may stand or do anything else.
    pub log: &'a JointLog,
}
