//! Blends into motions that are not known in time.

use iiwa_program::MotionIndex;

/// A blend before which the arm stopped, since the motion after it was not known in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateBlend {
    /// The motion whose target it blends away.
    pub after_motion: MotionIndex,
    /// When the motion after it is known, which is when the waits between both are over, in s.
    pub known_s: f64,
    /// By when it would have to be known for the arm to go on without a stop, in s.
    pub needed_s: f64,
}
