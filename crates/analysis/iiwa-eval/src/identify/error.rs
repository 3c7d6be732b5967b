//! Errors of identification.

use iiwa_program::Fault;

/// Reason why nothing could be identified.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// The program is not feasible for this robot.
    #[error("the program cannot be planned: {fault}")]
    Program {
        /// Index of the recording, from 0.
        recording: usize,
        /// Reason.
        fault: Fault,
    },
    /// The robot is never at the program's start.
    #[error(
        "the arm is never where the program starts; the nearest it comes is {:.2} deg away: is it \
         another program's recording, another robot's, or in other units?",
        .nearest_rad.to_degrees()
    )]
    NotThere {
        /// Index of the recording, from 0.
        recording: usize,
        /// Smallest distance from the start, the norm over the joints, in rad.
        nearest_rad: f64,
    },
    /// The robot remains at the start, or leaves the program before its first motion is complete.
    #[error(
        "the arm is where the program starts, but does not do its first motion: is it another \
         program's recording, another robot's, or in other units?"
    )]
    NoMotion {
        /// Index of the recording, from 0.
        recording: usize,
    },
}

impl IdentifyError {
    /// Returns the index of the recording, from 0.
    #[must_use]
    pub fn recording(&self) -> usize {
        match self {
            Self::Program { recording, .. }
            | Self::NotThere { recording, .. }
            | Self::NoMotion { recording } => *recording,
        }
    }
}
