//! Rigid bodies.

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
