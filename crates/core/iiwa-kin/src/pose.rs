//! Pose of a frame.

use crate::trig;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion};

/// Cosine of B below which A and C cannot be distinguished (gimbal lock).
const GIMBAL: f64 = 1e-12;

/// Position and orientation of a frame, as plain arrays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Origin, in m.
    pub position_m: [f64; 3],
    /// Rotation matrix, row-major; its columns are the axes of the frame (Larsen 2019, Eq. 2).
    pub rotation: [[f64; 3]; 3],
}

impl Pose {
    /// The reference frame itself.
    pub const IDENTITY: Self = Self {
        position_m: [0.0; 3],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };

    /// Pose at `position_m` with orientation A, B, C in rad as on KUKA controllers: a rotation
    /// about z by A, then about the new y by B, then about the new x by C.
    ///
    /// ```
    /// use iiwa_kin::Pose;
    ///
    /// let pose = Pose::from_xyz_abc([0.4, 0.0, 0.5], [0.0, std::f64::consts::PI, 0.0]);
    /// // The z axis points downwards.
    /// assert_eq!(pose.rotation[2][2], -1.0);
    /// ```
    #[must_use]
    pub fn from_xyz_abc(position_m: [f64; 3], abc_rad: [f64; 3]) -> Self {
        let ([sa, sb, sc], [ca, cb, cc]) = trig::sin_cos(&abc_rad);
        Self {
            position_m,
            rotation: [
                [ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc],
                [sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc],
                [-sb, cb * sc, cb * cc],
            ],
        }
    }

    /// KUKA's orientation angles A, B, C, in rad; B from -pi/2 to pi/2.
    ///
    /// If B is a quarter turn, only the sum or the difference of A and C is defined; A is then 0.
    ///
    /// ```
    /// use iiwa_kin::Pose;
    ///
    /// let abc = Pose::from_xyz_abc([0.0; 3], [0.3, -0.2, 2.9]).abc_rad();
    /// assert!((abc[0] - 0.3).abs() < 1e-15 && (abc[2] - 2.9).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn abc_rad(&self) -> [f64; 3] {
        let r = &self.rotation;
        let cos_b = r[0][0].hypot(r[1][0]);
        let (sin_a, cos_a) =
            if cos_b > GIMBAL { (r[1][0] / cos_b, r[0][0] / cos_b) } else { (0.0, 1.0) };
        // C follows from the chosen A. Near B = a quarter turn, A and C are each ill-conditioned
        // but their combination is not.
        let (sin_c, cos_c) = (sin_a * r[0][2] - cos_a * r[1][2], cos_a * r[1][1] - sin_a * r[0][1]);
        [trig::atan2(sin_a, cos_a), trig::atan2(-r[2][0], cos_b), trig::atan2(sin_c, cos_c)]
    }

    /// Pose of a frame `carried` that is fixed to this frame and given in it.
    ///
    /// ```
    /// use iiwa_kin::Pose;
    ///
    /// let base = Pose::from_xyz_abc([0.5, 0.0, 0.1], [std::f64::consts::FRAC_PI_2, 0.0, 0.0]);
    /// let point = base.then(&Pose::from_xyz_abc([0.2, 0.0, 0.0], [0.0; 3]));
    /// assert!((point.position_m[1] - 0.2).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn then(&self, carried: &Self) -> Self {
        let along = |row: &[f64; 3], x: f64, y: f64, z: f64| row[0] * x + row[1] * y + row[2] * z;
        let ([x, y, z], r) = (carried.position_m, &carried.rotation);
        Self {
            position_m: std::array::from_fn(|i| {
                self.position_m[i] + along(&self.rotation[i], x, y, z)
            }),
            rotation: self
                .rotation
                .map(|row| std::array::from_fn(|k| along(&row, r[0][k], r[1][k], r[2][k]))),
        }
    }

    /// Inverse pose: the reference frame expressed in this frame.
    ///
    /// ```
    /// use iiwa_kin::Pose;
    ///
    /// let pose = Pose::from_xyz_abc([0.5, 0.2, 0.1], [0.4, 0.3, 0.2]);
    /// let home = pose.then(&pose.inverse());
    /// assert!(home.position_m.iter().all(|x| x.abs() < 1e-15));
    /// ```
    #[must_use]
    pub fn inverse(&self) -> Self {
        let (p, r) = (self.position_m, &self.rotation);
        Self {
            position_m: std::array::from_fn(|i| {
                -(r[0][i] * p[0] + r[1][i] * p[1] + r[2][i] * p[2])
            }),
            rotation: std::array::from_fn(|i| [r[0][i], r[1][i], r[2][i]]),
        }
    }

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

    /// Unit quaternion `[x, y, z, w]` of the orientation, with `w >= 0`.
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
