//! A program of an experiment.

use iiwa_program::Program;

/// A program of an experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Its name: letters, digits and `-`.
    pub name: String,
    /// The program.
    pub program: Program,
}
