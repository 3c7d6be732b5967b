//! Texts on pages, provided by the surrounding program.

use iiwa_link::{
    ClientError,
    message::{DriveStatus, Refusal},
};

use crate::TwinError;

/// Texts of the program around the twin, which knows how its users can resolve an error.
#[derive(Clone, Copy, Debug)]
pub struct Wording {
    /// Formats a failure in one line.
    pub error: fn(&TwinError) -> String,
    /// Formats a failed request to the drive.
    pub request: fn(&ClientError) -> String,
    /// Returns advice for a rejected run of motions, which is appended to the rejection.
    pub refusal: fn(&Refusal) -> &'static str,
    /// Explains why runs cannot start while the robot's position is unknown.
    pub unknown_position: fn(&DriveStatus) -> String,
    /// Hint where to find the complete address of the page, as in `that the program has printed`.
    pub address: &'static str,
}
