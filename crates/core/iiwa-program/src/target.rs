//! Frames as written by users, and targets of Cartesian motions.

use iiwa_kin::{Pose, Status};

/// A frame: origin and orientation `R = Rz(a) Ry(b) Rx(c)`, as on KUKA's panels.
///
/// Lengths stay in mm and angles in rad, as written, so that a program reads back exactly.
///
/// ```
/// use iiwa_program::Frame;
///
/// let frame = Frame { xyz_mm: [100.0, 0.0, 50.0], abc_rad: [0.0, 0.0, std::f64::consts::PI] };
/// let pose = frame.pose();
/// assert_eq!(pose.position_m[0], 0.1);
/// assert!((pose.rotation[2][2] + 1.0).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// Origin x, y, z, in mm.
    pub xyz_mm: [f64; 3],
    /// Angles a, b, c, in rad: about z, then about the new y, then about the new x.
    pub abc_rad: [f64; 3],
}

impl Frame {
    /// Pose of this frame in the frame in which it is given.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose::from_xyz_abc(self.xyz_mm.map(|mm| mm * 1e-3), self.abc_rad)
    }
}

/// Converts a pose to a frame.
impl From<&Pose> for Frame {
    fn from(pose: &Pose) -> Self {
        Self { xyz_mm: pose.position_m.map(|m| m * 1e3), abc_rad: pose.abc_rad() }
    }
}

/// A TCP target frame, with the redundancy parameters that make the joint positions unique.
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
    /// Frame in its base.
    pub frame: Frame,
    /// Base of the frame; that of the motion or of the program by default.
    pub base: Option<String>,
    /// Position of A3 at the target, in rad; as at the start of the motion by default.
    pub e1_rad: Option<f64>,
    /// Arm configuration (sides of shoulder, elbow and wrist); as at the start of the motion by
    /// default. Used in point-to-point motions only, because it cannot change along a path.
    pub status: Option<Status>,
    /// Signs of all joint positions, from bit 0 for A1. The other parameters determine them, so
    /// this is only a check.
    pub turn: Option<u8>,
}

impl Target {
    /// Target in the motion's base, with the redundancy of the start of the motion.
    #[must_use]
    pub fn at(frame: Frame) -> Self {
        Self { frame, base: None, e1_rad: None, status: None, turn: None }
    }
}

/// A target given inline, or by its name among the program's frames.
#[derive(Clone, Debug, PartialEq)]
pub enum TargetRef {
    /// Name of one of [`Workcell::frames`](crate::Workcell::frames).
    Named(String),
    /// Inline target.
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
