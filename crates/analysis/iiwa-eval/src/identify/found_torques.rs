//! Loads and friction as recorded torques show them.

use iiwa_kin::{Friction, Load};

use crate::Estimate;

/// What recorded torques show.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FoundTorques {
    /// What hangs on the flange; recordings whose programs state the same load are taken to have the same.
    pub loads: Vec<FoundLoad>,
    /// Viscous friction of each joint, in Nm s/rad, and Coulomb's, in Nm; none where the joint hardly moves.
    pub viscous_nm_s_rad: [Option<Estimate>; 7],
    /// The same of what is there at any speed.
    pub coulomb_nm: [Option<Estimate>; 7],
    /// Root mean square of what is left over of each joint's torque, as averaged over [`window_s`](Self::window_s), in Nm.
    pub residual_nm: [f64; 7],
    /// Over how long torques are averaged, in s.
    pub window_s: f64,
    /// Whether torques had the sign of plans already, and not that of KUKA's controller.
    pub turned: bool,
}

/// A load.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FoundLoad {
    /// The recordings, from 0.
    pub recordings: Vec<usize>,
    /// What their programs state.
    pub stated: Option<Load>,
    /// Mass, in kg, if the recordings tell.
    pub mass_kg: Option<Estimate>,
    /// Centre of mass in the flange's frame, in mm, as far as the recordings tell.
    pub center_mm: [Option<Estimate>; 3],
}

impl FoundLoad {
    /// The load for programs, without moments of inertia; none if mass or centre are not known.
    #[must_use]
    pub fn load(&self) -> Option<Load> {
        let [Some(x), Some(y), Some(z)] = self.center_mm else { return None };
        let center_mm = [x.value, y.value, z.value];
        Some(Load { mass_kg: self.mass_kg?.value, center_mm, ..Load::default() })
    }

    /// What the recordings do not tell of it, in words.
    #[must_use]
    pub fn untold(&self) -> Vec<&'static str> {
        const CENTER: [&str; 3] = ["x of the centre", "y of the centre", "z of the centre"];
        let center = self.center_mm.iter().zip(CENTER);
        let center = center.filter(|(found, _)| found.is_none()).map(|(_, name)| name);
        self.mass_kg.is_none().then_some("the mass").into_iter().chain(center).collect()
    }

    /// Whether it is none at all, within its uncertainty.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        self.mass_kg.is_some_and(|mass| mass.holds(0.0))
    }
}

impl FoundTorques {
    /// Friction as it was found; that of `model` where it was not. What is below 0 within its uncertainty is 0.
    #[must_use]
    pub fn friction(&self, model: &Friction) -> Friction {
        let value = |found: &Option<Estimate>, known: f64| match found {
            Some(found) => found.value.max(0.0),
            None => known,
        };
        let all = |found: &[Option<Estimate>; 7], known: &[f64; 7]| {
            std::array::from_fn(|j| value(&found[j], known[j]))
        };
        Friction {
            viscous_nm_s_rad: all(&self.viscous_nm_s_rad, &model.viscous_nm_s_rad),
            coulomb_nm: all(&self.coulomb_nm, &model.coulomb_nm),
        }
    }
}
