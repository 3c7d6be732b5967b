//! Blends into motions that are not known in time.

use iiwa_program::MotionIndex;

/// Blend before which the robot stopped, because the motion after it was not known in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateBlend {
    /// Motion whose target the blend cuts off.
    pub after_motion: MotionIndex,
    /// Time at which the next motion is known, the end of the waits in between, in s.
    pub known_s: f64,
    /// Latest time at which the next motion would have to be known to avoid the stop, in s.
    pub needed_s: f64,
}
