//! Options of blends.

use iiwa_kin::Robot;

use crate::{continuity::Continuity, crossing::BlendSearch, polynomial::KAPPA_MIN_ACCELERATION};

/// Shape of a blend.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BlendShape {
    /// The shape that the LBR iiwa uses: the blend polynomial of Larsen 2019, Eq. 39, with the
    /// kappa(gamma) of the robot, by default that of Eq. 38.
    Iiwa,
    /// The blend polynomial with kappa = 0 (Larsen 2019, Eq. 13).
    Alpha(Continuity),
    /// The blend polynomial with the smallest mean acceleration (Larsen 2019, Eq. 26, k = 15/2).
    MinAcceleration,
    /// A circle in joint space (Larsen 2019, Eq. 32).
    Circle,
}

impl BlendShape {
    /// Weight of beta in a blend of this shape, at a corner of `gamma_deg`.
    pub(crate) fn kappa(self, robot: &Robot, gamma_deg: f64) -> f64 {
        match self {
            Self::Iiwa => robot.kappa(gamma_deg),
            Self::MinAcceleration => KAPPA_MIN_ACCELERATION,
            Self::Alpha(_) | Self::Circle => 0.0,
        }
    }

    /// Weight of beta in a blend of this shape between two TCP paths.
    pub(crate) fn tcp_kappa(self, robot: &Robot, gamma_deg: f64) -> f64 {
        match self {
            Self::Iiwa => robot.tcp_kappa(gamma_deg),
            _ => self.kappa(robot, gamma_deg),
        }
    }
}

/// Options of the blends of a path.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_path::{BlendShape, Continuity, JointPath, PathOptions};
/// use iiwa_program::{Blend, Program};
///
/// let program = Program::from_deg([0.0; 7])
///     .ptp_deg([40.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
///     .blend(Blend::Fraction(0.3))
///     .ptp_deg([40.0, 30.0, 0.0, 0.0, 0.0, 0.0, 0.0])
///     .build();
/// let blend_shape = BlendShape::Alpha(Continuity::Third);
/// let options = PathOptions { blend_shape, ..PathOptions::default() };
/// let path = JointPath::with_options(&program, &Robot::default(), options)?;
/// assert_eq!(path.blends().count(), 1);
/// # Ok::<(), iiwa_program::Fault>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathOptions {
    /// Shape of blends.
    pub blend_shape: BlendShape,
    /// Search for the start and the end of blends with a radius in mm.
    pub blend_search: BlendSearch,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self { blend_shape: BlendShape::Iiwa, blend_search: BlendSearch::FirstCrossing }
    }
}
