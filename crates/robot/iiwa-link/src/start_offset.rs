//! Distance of the robot from the start of a program.

use std::fmt;

use crate::START_TOLERANCE_RAD;
use iiwa_kin::Joints;

/// Joint with the largest distance from the start of a program.
#[derive(Clone, Copy, Debug)]
pub struct StartOffset {
    /// Index from 0.
    joint: usize,
    at_rad: f64,
    start_rad: f64,
}

impl StartOffset {
    /// Determines the joint for a robot at `joints_rad` and a program start.
    #[must_use]
    pub fn new(joints_rad: &Joints, start_rad: &Joints) -> Self {
        let off = |j: &usize| (joints_rad[*j] - start_rad[*j]).abs();
        let joint = (0..7).max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
        Self { joint, at_rad: joints_rad[joint], start_rad: start_rad[joint] }
    }

    /// Returns the distance of this joint, in rad.
    #[must_use]
    pub fn rad(&self) -> f64 {
        (self.at_rad - self.start_rad).abs()
    }

    /// Returns true if a drive accepts the program: up to [`START_TOLERANCE_RAD`].
    #[must_use]
    pub fn is_within_tolerance(&self) -> bool {
        self.rad() <= START_TOLERANCE_RAD
    }
}

impl fmt::Display for StartOffset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the robot is not at the program's start: joint A{} is at {:.3} deg, the program \
             starts at {:.3} deg",
            self.joint + 1,
            self.at_rad.to_degrees(),
            self.start_rad.to_degrees()
        )
    }
}
