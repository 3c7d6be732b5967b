//! Payloads and friction identified from recorded torques.

use iiwa_kin::{Friction, Load};

use crate::Estimate;

/// Result of the evaluation of recorded torques.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TorqueEstimates {
    /// Payloads. Recordings whose programs state the same payload are assumed to have the same one.
    pub loads: Vec<LoadEstimate>,
    /// Viscous friction of each joint, in Nm s/rad; none where the joint hardly moves.
    pub viscous_nm_s_rad: [Option<Estimate>; 7],
    /// Coulomb friction of each joint, in Nm, independent of the speed; none where the joint hardly
    /// moves.
    pub coulomb_nm: [Option<Estimate>; 7],
    /// Root mean square residual of each joint's torque, averaged over
    /// [`window_s`](Self::window_s), in Nm.
    pub residual_nm: [f64; 7],
    /// Averaging time of torques, in s.
    pub window_s: f64,
    /// `true` if the sign of the recorded torques is not that of their format, and was inverted.
    pub turned: bool,
}

/// Identified payload.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LoadEstimate {
    /// Indices of the recordings, from 0.
    pub recordings: Vec<usize>,
    /// Payload stated by their programs.
    pub stated: Option<Load>,
    /// Mass, in kg, if the recordings determine it.
    pub mass_kg: Option<Estimate>,
    /// Centre of mass in the flange frame, in mm, for the coordinates that the recordings
    /// determine.
    pub center_mm: [Option<Estimate>; 3],
}

impl LoadEstimate {
    /// Returns the payload for programs, without moments of inertia; none if mass or centre of mass
    /// is unknown.
    #[must_use]
    pub fn load(&self) -> Option<Load> {
        let [Some(x), Some(y), Some(z)] = self.center_mm else { return None };
        let center_mm = [x.value, y.value, z.value];
        Some(Load { mass_kg: self.mass_kg?.value, center_mm, ..Load::default() })
    }

    /// Returns the names of the quantities that the recordings do not determine.
    #[must_use]
    pub fn untold(&self) -> Vec<&'static str> {
        const CENTER: [&str; 3] = ["x of the centre", "y of the centre", "z of the centre"];
        let center = self.center_mm.iter().zip(CENTER);
        let center = center.filter(|(estimate, _)| estimate.is_none()).map(|(_, name)| name);
        self.mass_kg.is_none().then_some("the mass").into_iter().chain(center).collect()
    }

    /// Returns true if the mass is zero within its uncertainty.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        self.mass_kg.is_some_and(|mass| mass.holds(0.0))
    }
}

impl TorqueEstimates {
    /// Returns the identified friction, or that of `model` where it was not identified. Negative
    /// values are set to 0.
    #[must_use]
    pub fn friction(&self, model: &Friction) -> Friction {
        let value = |estimate: &Option<Estimate>, known: f64| match estimate {
            Some(estimate) => estimate.value.max(0.0),
            None => known,
        };
        let all = |estimate: &[Option<Estimate>; 7], known: &[f64; 7]| {
            std::array::from_fn(|j| value(&estimate[j], known[j]))
        };
        Friction {
            viscous_nm_s_rad: all(&self.viscous_nm_s_rad, &model.viscous_nm_s_rad),
            coulomb_nm: all(&self.coulomb_nm, &model.coulomb_nm),
        }
    }
}
