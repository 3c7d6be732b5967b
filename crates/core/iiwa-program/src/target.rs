//! Where a Cartesian motion goes.

use iiwa_kin::Status;

use crate::frame::Frame;

/// A frame to which the TCP goes, with what settles the arm's redundancy there.
///
/// ```
/// use iiwa_program::{Frame, Target};
///
/// let frame = Frame { xyz_mm: [500.0, 0.0, 300.0], abc_rad: [0.0, 0.0, 3.1] };
/// let target = Target { e1_rad: Some(0.2), ..Target::at(frame) };
/// assert_eq!(target.status, None);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Where it is in its base.
    pub frame: Frame,
    /// The base; that of the motion or of the program if absent.
    pub base: Option<String>,
    /// The position of A3 there, in rad; as where the motion starts if absent.
    pub e1_rad: Option<f64>,
    /// On which side of shoulder, elbow and wrist the arm is; as where the motion starts if absent. It counts in
    /// point-to-point motions only: along a path it cannot change.
    pub status: Option<Status>,
    /// The signs of all joints, from bit 0 for A1. The other numbers settle them: they are held against these.
    pub turn: Option<u8>,
}

impl Target {
    /// A frame in the motion's base, with the redundancy of where the motion starts.
    #[must_use]
    pub fn at(frame: Frame) -> Self {
        Self { frame, base: None, e1_rad: None, status: None, turn: None }
    }
}

/// A target that is given where it is used, or by its name among the program's frames.
#[derive(Clone, Debug, PartialEq)]
pub enum TargetRef {
    /// One of [`Workcell::frames`](crate::Workcell::frames).
    Named(String),
    /// This one.
    Given(Target),
}

impl From<Frame> for TargetRef {
    fn from(frame: Frame) -> Self {
        Self::Given(Target::at(frame))
    }
}

impl From<&str> for TargetRef {
    fn from(name: &str) -> Self {
        Self::Named(name.to_owned())
    }
}
