//! Payload at the flange.

use std::str::FromStr;

use thiserror::Error;

use crate::{
    Pose, RigidBody,
    rotation::{product, transposed},
};

/// A payload at the flange.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Mass, in kg.
    pub mass_kg: f64,
    /// Centre of mass in the flange frame, in mm.
    pub center_mm: [f64; 3],
    /// Principal moments of inertia about the centre of mass, in kg m^2.
    pub inertia_kg_m2: [f64; 3],
    /// Orientation of the principal axes in the flange frame: a, b, c in rad.
    pub abc_rad: [f64; 3],
}

/// Parses `KG` or `KG,X,Y,Z`: the mass and its centre, in mm.
impl FromStr for Load {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (mass_kg, center_mm) = match numbers(text)?[..] {
            [mass_kg] => (mass_kg, [0.0; 3]),
            [mass_kg, x, y, z] => (mass_kg, [x, y, z]),
            _ => {
                return Err(
                    "expected a mass in kg, or a mass and x, y, z of its centre in mm".to_owned()
                );
            }
        };
        let load = Self { mass_kg, center_mm, ..Self::default() };
        load.check().map_err(|error| error.to_string())?;
        Ok(load)
    }
}

/// Error: a load that no arm of this size carries, such as a mass in grams.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error(
    "the load is not physically possible: its mass must be 0 to {} kg, its centre at most {} mm \
     from the flange on each axis, and its moments of inertia 0 to {} kg m^2",
    Load::MAX_MASS_KG,
    Load::MAX_CENTER_MM,
    Load::MAX_INERTIA_KG_M2
)]
pub struct ImpossibleLoad;

/// Parses finite numbers separated by commas.
pub(crate) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let number = |field: &str| {
        let value = field.trim().parse().ok().filter(|value: &f64| value.is_finite());
        value.ok_or_else(|| format!("`{field}` is not a number"))
    };
    text.split(',').map(number).collect()
}

impl Load {
    /// Largest mass, in kg: seventy times the largest rated payload. Torques of larger masses would
    /// be numbers without meaning.
    pub const MAX_MASS_KG: f64 = 1000.0;
    /// Largest coordinate of the centre of mass, in mm.
    pub const MAX_CENTER_MM: f64 = 10_000.0;
    /// Largest moment of inertia, in kg m^2.
    pub const MAX_INERTIA_KG_M2: f64 = 1000.0;

    /// Checks that mass, centre and moments of inertia are within their bounds.
    ///
    /// # Errors
    ///
    /// [`ImpossibleLoad`] if they are not.
    pub fn check(&self) -> Result<(), ImpossibleLoad> {
        let within = |numbers: &[f64], max: f64| numbers.iter().all(|number| number.abs() <= max);
        let is_possible = self.body().is_possible()
            && within(&[self.mass_kg], Self::MAX_MASS_KG)
            && within(&self.center_mm, Self::MAX_CENTER_MM)
            && within(&self.inertia_kg_m2, Self::MAX_INERTIA_KG_M2);
        if is_possible { Ok(()) } else { Err(ImpossibleLoad) }
    }

    /// The payload as a rigid body in the flange frame.
    ///
    /// ```
    /// use iiwa_kin::Load;
    ///
    /// let quarter_turn = [std::f64::consts::FRAC_PI_2, 0.0, 0.0];
    /// let load = Load {
    ///     mass_kg: 2.0,
    ///     inertia_kg_m2: [0.1, 0.2, 0.3],
    ///     abc_rad: quarter_turn,
    ///     ..Load::default()
    /// };
    /// let [xx, _, _, yy, _, zz] = load.body().inertia_kg_m2;
    /// assert!((xx - 0.2).abs() < 1e-15 && (yy - 0.1).abs() < 1e-15 && (zz - 0.3).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn body(&self) -> RigidBody {
        let axes = Pose::from_xyz_abc([0.0; 3], self.abc_rad).rotation;
        let scaled = axes.map(|row| std::array::from_fn(|k| row[k] * self.inertia_kg_m2[k]));
        let i = product(&scaled, &transposed(&axes));
        RigidBody {
            mass_kg: self.mass_kg,
            center_m: self.center_mm.map(|mm| mm / 1e3),
            inertia_kg_m2: [i[0][0], i[0][1], i[0][2], i[1][1], i[1][2], i[2][2]],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_have_their_centre_in_metres() {
        let load: Load = "4.2,10,-20,90.5".parse().unwrap();
        assert_eq!((load.mass_kg, load.center_mm), (4.2, [10.0, -20.0, 90.5]));
        let body = load.body();
        assert_eq!((body.mass_kg, body.center_m), (4.2, [0.01, -0.02, 0.0905]));
    }

    /// A mass 100 mm in front of a flange that points forwards, on an arm stretched forwards.
    #[test]
    fn gravity_acts_at_the_centre() {
        use crate::Robot;

        let q = [0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0];
        let load = Load { mass_kg: 2.0, ..Load::default() };
        let far = Load { center_mm: [0.0, 0.0, 100.0], ..load };
        let [near, far] = [load, far]
            .map(|load| Robot::default().dynamics().with_load(&load).gravity_torques(&q)[1].abs());
        let more_nm = 2.0 * 9.81 * 0.1;
        assert!((far - near - more_nm).abs() < 1e-3 * more_nm, "{near} Nm, {far} Nm");
    }
}
