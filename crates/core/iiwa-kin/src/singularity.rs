//! Distance of the arm from singularities.

use std::fmt;

use crate::{Joints, Robot, forward::sin_cos_of_joints};

/// Distances from the three singularities that the arm has while joint A3 follows a separate law;
/// each is 0 at the singularity and at most 1. Their product, times lengths, is the determinant of
/// the Jacobian without the A3 column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Singularity {
    /// Distance of the wrist from the plane through the axes of A1 and A2, as a share of the arm
    /// length d3 + d5. At 0, any other E1 would be out of reach.
    pub shoulder: f64,
    /// |sin A4|: 0 if the arm is stretched.
    pub elbow: f64,
    /// |sin A6|: 0 if the flange is in line with the forearm.
    pub wrist: f64,
}

/// Singular part of the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SingularPart {
    /// The wrist is in the plane through the axes of A1 and A2.
    Shoulder,
    /// A4 is 0.
    Elbow,
    /// A6 is 0.
    Wrist,
}

impl Singularity {
    /// Smallest of the three distances, and the part that it belongs to.
    #[must_use]
    pub fn nearest(&self) -> (f64, SingularPart) {
        let mut nearest = (self.shoulder, SingularPart::Shoulder);
        for other in [(self.elbow, SingularPart::Elbow), (self.wrist, SingularPart::Wrist)] {
            if other.0 < nearest.0 {
                nearest = other;
            }
        }
        nearest
    }
}

impl fmt::Display for SingularPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Shoulder => "shoulder",
            Self::Elbow => "elbow",
            Self::Wrist => "wrist",
        })
    }
}

impl Robot {
    /// Distances from the singularities at `joints_rad`.
    ///
    /// ```
    /// use iiwa_kin::{Robot, SingularPart};
    ///
    /// let near = Robot::lbr_iiwa_7_r800().singularity(&[0.0, 0.5, 0.0, -1.0, 0.0, 0.02, 0.0]);
    /// let (distance, part) = near.nearest();
    /// assert!((distance - 0.02).abs() < 1e-5);
    /// assert_eq!(part, SingularPart::Wrist);
    /// ```
    #[must_use]
    pub fn singularity(&self, joints_rad: &Joints) -> Singularity {
        let (sin, _) = sin_cos_of_joints(joints_rad);
        let [_, upper_arm, forearm, _] = self.offsets();
        Singularity {
            shoulder: self.wrist_ahead_m(joints_rad).abs() / (upper_arm + forearm),
            elbow: sin[3].abs(),
            wrist: sin[5].abs(),
        }
    }

    /// The wrist's x coordinate in the frame rotated by joint A1, in m.
    #[must_use]
    pub(crate) fn wrist_ahead_m(&self, joints_rad: &Joints) -> f64 {
        let (s, c) = sin_cos_of_joints(joints_rad);
        let [_, upper_arm, forearm, _] = self.offsets();
        upper_arm * s[1] + forearm * (s[1] * c[3] - c[1] * s[3] * c[2])
    }
}
