//! Frames as written by users.

use iiwa_kin::Pose;

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
