//! How the program around the twin words what pages show.

use iiwa_link::{
    ClientError,
    message::{Refusal, Status},
};

use crate::TwinError;

/// Words of the program around the twin. It knows what its users can do about an error, and says so.
#[derive(Clone, Copy, Debug)]
pub struct Wording {
    /// A failure, in one line.
    pub error: fn(&TwinError) -> String,
    /// A request to the drive that failed.
    pub request: fn(&ClientError) -> String,
    /// What to do about a run of motions that was refused; it is appended to the refusal.
    pub refusal: fn(&Refusal) -> &'static str,
    /// Why no run can start while the robot's position is unknown.
    pub unknown_position: fn(&Status) -> String,
    /// Where the whole address of the page is found, as in `that the program has printed`.
    pub address: &'static str,
}
