//! Rigid bodies, and the mass moments by which the equations of motion use them.

use crate::rotation::{Mat3, Vec3};

/// A rigid body, such as a robot link or a payload: the content of a URDF `inertial` element
/// without rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RigidBody {
    /// Mass, in kg.
    pub mass_kg: f64,
    /// Centre of mass, in m.
    pub center_m: [f64; 3],
    /// Inertia tensor about the centre of mass, in kg m^2: xx, xy, xz, yy, yz, zz.
    pub inertia_kg_m2: [f64; 6],
}

impl RigidBody {
    /// Point mass.
    #[must_use]
    pub fn point(mass_kg: f64, at_m: [f64; 3]) -> Self {
        Self { mass_kg, center_m: at_m, inertia_kg_m2: [0.0; 6] }
    }

    /// Combines two bodies into one.
    ///
    /// ```
    /// use iiwa_kin::RigidBody;
    ///
    /// let bar =
    ///     RigidBody::point(1.0, [-0.5, 0.0, 0.0]).with(&RigidBody::point(1.0, [0.5, 0.0, 0.0]));
    /// assert_eq!((bar.mass_kg, bar.center_m), (2.0, [0.0; 3]));
    /// assert_eq!(bar.inertia_kg_m2, [0.0, 0.0, 0.0, 0.5, 0.0, 0.5]);
    /// ```
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        let mass_kg = self.mass_kg + other.mass_kg;
        if other.mass_kg == 0.0 || mass_kg == 0.0 {
            return *self;
        }
        let share = other.mass_kg / mass_kg;
        let [x, y, z]: [f64; 3] = std::array::from_fn(|i| other.center_m[i] - self.center_m[i]);
        let m = self.mass_kg * share;
        let steiner = [y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y];
        Self {
            mass_kg,
            center_m: std::array::from_fn(|i| {
                self.center_m[i] + share * (other.center_m[i] - self.center_m[i])
            }),
            inertia_kg_m2: std::array::from_fn(|i| {
                self.inertia_kg_m2[i] + other.inertia_kg_m2[i] + m * steiner[i]
            }),
        }
    }

    /// Returns true if the mass is finite and not negative, and the inertia tensor is positive
    /// semidefinite. The triangle inequality of the principal moments is not required, because
    /// identified inertias often violate it.
    #[must_use]
    pub fn is_possible(&self) -> bool {
        let [xx, xy, xz, yy, yz, zz] = self.inertia_kg_m2;
        // Tolerance for rounding.
        let small = 1e-9 * (xx.abs() + yy.abs() + zz.abs());
        let minors =
            [(xx, yy, xy), (xx, zz, xz), (yy, zz, yz)].map(|(a, b, off)| a * b - off * off);
        let determinant = xx * minors[2] - xy * (xy * zz - xz * yz) + xz * (xy * yz - xz * yy);
        let finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        finite(&self.center_m)
            && finite(&self.inertia_kg_m2)
            && (0.0..f64::INFINITY).contains(&self.mass_kg)
            && [xx, yy, zz].iter().all(|moment| *moment >= -small)
            && minors.iter().all(|minor| *minor >= -small * small)
            && determinant >= -small.powi(3)
    }
}

/// Moments of a body's mass about the origin of its frame. The moments of bodies that move together
/// add up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moments {
    pub(crate) mass_kg: f64,
    /// Sum of m x.
    pub(crate) first_kg_m: Vec3<f64>,
    /// Sum of m x x^T: xx, xy, xz, yy, yz, zz.
    pub(crate) second_kg_m2: [f64; 6],
}

impl From<&RigidBody> for Moments {
    fn from(body: &RigidBody) -> Self {
        let m = body.mass_kg;
        let [x, y, z] = body.center_m;
        let [ixx, ixy, ixz, iyy, iyz, izz] = body.inertia_kg_m2;
        let half = 0.5 * (ixx + iyy + izz);
        Self {
            mass_kg: m,
            first_kg_m: [m * x, m * y, m * z],
            second_kg_m2: [
                half - ixx + m * x * x,
                m * x * y - ixy,
                m * x * z - ixz,
                half - iyy + m * y * y,
                m * y * z - iyz,
                half - izz + m * z * z,
            ],
        }
    }
}

impl Moments {
    /// Moments of both bodies together.
    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self {
            mass_kg: self.mass_kg + other.mass_kg,
            first_kg_m: std::array::from_fn(|i| self.first_kg_m[i] + other.first_kg_m[i]),
            second_kg_m2: std::array::from_fn(|i| self.second_kg_m2[i] + other.second_kg_m2[i]),
        }
    }

    /// Moments in another frame, in which the axes of this frame are `axes`.
    pub(crate) fn turned(&self, axes: &[Vec3<f64>; 3]) -> Self {
        let [xx, xy, xz, yy, yz, zz] = self.second_kg_m2;
        let second = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        let along = |v: &Vec3<f64>, i: usize| -> f64 { (0..3).map(|k| v[k] * axes[k][i]).sum() };
        let half: Mat3<f64> = second.map(|row| std::array::from_fn(|i| along(&row, i)));
        let turned = |i: usize, j: usize| (0..3).map(|k| axes[k][i] * half[k][j]).sum();
        Self {
            mass_kg: self.mass_kg,
            first_kg_m: std::array::from_fn(|i| along(&self.first_kg_m, i)),
            second_kg_m2: [
                turned(0, 0),
                turned(0, 1),
                turned(0, 2),
                turned(1, 1),
                turned(1, 2),
                turned(2, 2),
            ],
        }
    }

    /// Moments about a point `d` behind the origin on the z axis, so that the body is `d` further
    /// along that axis.
    pub(crate) fn shifted(&self, d: f64) -> Self {
        let [hx, hy, hz] = self.first_kg_m;
        let [xx, xy, xz, yy, yz, zz] = self.second_kg_m2;
        Self {
            mass_kg: self.mass_kg,
            first_kg_m: [hx, hy, hz + d * self.mass_kg],
            second_kg_m2: [
                xx,
                xy,
                xz + d * hx,
                yy,
                yz + d * hy,
                zz + d * (2.0 * hz + d * self.mass_kg),
            ],
        }
    }
}
