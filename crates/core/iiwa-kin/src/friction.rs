//! Joint friction.

use crate::Joints;

/// Joint friction on the output side of the gears, where the torque sensors are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction {
    /// Viscous friction coefficients, in Nm s/rad.
    pub viscous_nm_s_rad: Joints,
    /// Coulomb friction, independent of the speed, in Nm.
    pub coulomb_nm: Joints,
}

impl Friction {
    /// Friction torques, in Nm, at joint velocities in rad/s; 0 for a joint at rest.
    ///
    /// ```
    /// use iiwa_kin::Friction;
    ///
    /// let friction = Friction { viscous_nm_s_rad: [0.2; 7], coulomb_nm: [0.1; 7] };
    /// let torques = friction.torques_nm(&[1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    /// assert!(
    ///     (torques[0] - 0.3).abs() < 1e-15
    ///         && (torques[1] + 0.3).abs() < 1e-15
    ///         && torques[2] == 0.0
    /// );
    /// ```
    #[must_use]
    pub fn torques_nm(&self, velocity_rad_s: &Joints) -> Joints {
        std::array::from_fn(|j| {
            let v = velocity_rad_s[j];
            let coulomb = if v == 0.0 { 0.0 } else { self.coulomb_nm[j].copysign(v) };
            self.viscous_nm_s_rad[j] * v + coulomb
        })
    }
}
