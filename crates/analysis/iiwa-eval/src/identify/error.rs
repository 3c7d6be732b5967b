//! Why nothing could be identified.

use iiwa_program::Fault;

/// Why nothing could be identified.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// The program is none for this robot.
    #[error("the program cannot be planned: {fault}")]
    Program {
        /// The recording, from 0.
        recording: usize,
        /// What is wrong.
        fault: Fault,
    },
    /// The arm is never where the program begins.
    #[error(
        "the arm is never where the program starts; the nearest it comes is {:.2} deg away: is it another \
         program's recording, another robot's, or in other units?",
        .nearest_rad.to_degrees()
    )]
    NotThere {
        /// The recording, from 0.
        recording: usize,
        /// The smallest distance from the start, the norm of the joints, in rad.
        nearest_rad: f64,
    },
    /// It stands, or leaves the program, before it has done any of it.
    #[error(
        "the arm is where the program starts, but does not do its first motion: is it another program's \
         recording, another robot's, or in other units?"
    )]
    NoMotion {
        /// The recording, from 0.
        recording: usize,
    },
}

impl IdentifyError {
    /// Which recording it is about, from 0.
    #[must_use]
    pub fn recording(&self) -> usize {
        match self {
            Self::Program { recording, .. }
            | Self::NotThere { recording, .. }
            | Self::NoMotion { recording } => *recording,
        }
    }
}
