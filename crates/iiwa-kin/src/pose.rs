//! Where a frame is.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion};

/// Position and orientation of a frame, as plain arrays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Origin, in m.
    pub position_m: [f64; 3],
    /// Rotation matrix, row-major: its columns are the frame's axes (Larsen 2019, Eq. 2).
    pub rotation: [[f64; 3]; 3],
}

impl Pose {
    /// The frame that everything else is given in.
    pub const IDENTITY: Self = Self {
        position_m: [0.0; 3],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };

    /// The pose as an isometry (translation in m).
    ///
    /// ```
    /// use nalgebra::Point3;
    ///
    /// let pose = iiwa_kin::Robot::lbr_iiwa_7_r800().flange_pose(&[0.0; 7]);
    /// // A point 10 cm in front of the flange.
    /// let ahead = pose.to_isometry() * Point3::new(0.0, 0.0, 0.1);
    /// assert!((ahead.z - 1.392).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn to_isometry(&self) -> Isometry3<f64> {
        let rotation = Rotation3::from_matrix_unchecked(self.rotation_matrix());
        Isometry3::from_parts(
            Translation3::from(self.position_m),
            UnitQuaternion::from_rotation_matrix(&rotation),
        )
    }

    /// The rotation as a matrix.
    #[must_use]
    pub fn rotation_matrix(&self) -> Matrix3<f64> {
        Matrix3::from_row_slice(self.rotation.as_flattened())
    }

    /// Orientation as a unit quaternion `[x, y, z, w]` with `w >= 0`.
    ///
    /// ```
    /// assert_eq!(iiwa_kin::Pose::IDENTITY.quaternion_xyzw(), [0.0, 0.0, 0.0, 1.0]);
    /// ```
    #[must_use]
    pub fn quaternion_xyzw(&self) -> [f64; 4] {
        let q = self.to_isometry().rotation;
        let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
        [q.i * sign, q.j * sign, q.k * sign, q.w * sign]
    }
}
