//! Programs with loads, and the results of an independent solver.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::{Joints, Load, Pose, RigidBody, Robot};
use iiwa_path::JointPath;
use iiwa_program::{Motion, MotionIndex, Mount, Program};
use nalgebra::{Matrix3, SymmetricEigen};
use serde::Deserialize;

use crate::fixture;

/// Case of `fixtures/reference/torque.json`.
#[derive(Deserialize)]
pub struct TorqueCase {
    /// Number of the case.
    pub id: usize,
    links: Vec<Body>,
    load: Body,
    gravity_m_s2: [f64; 3],
    /// Torque limits of the joints, in Nm.
    pub torque_limit_nm: Joints,
    torque_limit_share: f64,
    /// Durations, without settle time.
    pub motion_s: Durations,
    program: serde_json::Value,
    /// Largest static torque along the path, relative to the limit.
    pub static_peak_share: f64,
    /// Peak torques without torque limits.
    pub peak_torque_share: PeakShares,
    /// Work and power without torque limits.
    pub energy: Energies,
}

#[derive(Deserialize)]
struct Body {
    mass_kg: f64,
    center_m: [f64; 3],
    inertia_kg_m2: [f64; 6],
}

/// Durations of a program, in s.
#[derive(Deserialize)]
pub struct Durations {
    /// Duration with velocity and acceleration limits.
    pub acceleration: f64,
    /// Duration with velocity, acceleration and jerk limits.
    pub jerk: f64,
    /// Duration with velocity, acceleration and torque limits.
    pub acceleration_torque: f64,
    /// Duration with all limits.
    pub jerk_torque: f64,
}

/// Peak torques relative to the torque limits.
#[derive(Deserialize)]
pub struct PeakShares {
    /// Peaks with acceleration limits.
    pub acceleration: Joints,
    /// Peaks with jerk limits.
    pub jerk: Joints,
}

/// Work and power.
#[derive(Deserialize)]
pub struct Energies {
    /// Work and power with jerk limits.
    pub jerk: Energy,
}

/// Work and power of one plan.
#[derive(Deserialize)]
pub struct Energy {
    /// Work done by the joints, in J.
    pub positive_j: f64,
    /// Work done on the joints, in J.
    pub negative_j: f64,
    /// Work done by each joint, in J.
    pub positive_per_joint_j: Joints,
    /// Peak power of the joints, in W.
    pub peak_power_w: f64,
}

#[derive(Deserialize)]
struct TorqueCases {
    cases: Vec<TorqueCase>,
}

impl From<&Body> for RigidBody {
    fn from(body: &Body) -> Self {
        let Body { mass_kg, center_m, inertia_kg_m2 } = *body;
        Self { mass_kg, center_m, inertia_kg_m2 }
    }
}

/// Returns the load with its principal axes.
fn load(body: &Body) -> Load {
    let [xx, xy, xz, yy, yz, zz] = body.inertia_kg_m2;
    let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let SymmetricEigen { eigenvalues, eigenvectors: mut axes } = SymmetricEigen::new(tensor);
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    let rotation = std::array::from_fn(|i| std::array::from_fn(|k| axes[(i, k)]));
    Load {
        mass_kg: body.mass_kg,
        center_mm: body.center_m.map(|m| 1e3 * m),
        inertia_kg_m2: eigenvalues.into(),
        abc_rad: Pose { position_m: [0.0; 3], rotation }.abc_rad(),
    }
}

impl TorqueCase {
    /// Returns the path of the case, with or without torque limits.
    ///
    /// # Panics
    ///
    /// Panics if the case is not one of these programs.
    #[must_use]
    pub fn path(&self, limits_torque: bool) -> JointPath {
        let mut program = Program::from_json(&self.program.to_string()).unwrap();
        program.motions.insert(0, Motion::Load(Some(load(&self.load).into())));
        program.workcell.mount = match self.gravity_m_s2 {
            [0.0, 0.0, z] if z > 0.0 => Mount::from_rpy_deg([180.0, 0.0, 0.0]),
            [x, 0.0, 0.0] if x > 0.0 => Mount::from_rpy_deg([0.0, 90.0, 0.0]),
            _ => Mount::default(),
        };
        program.workcell.torque_limit_rel = limits_torque.then_some(self.torque_limit_share);
        let links: Vec<RigidBody> = self.links.iter().map(RigidBody::from).collect();
        let robot = Robot::built_in(program.robot.as_deref().unwrap()).unwrap();
        let robot = robot.with_links(links.try_into().unwrap());
        let path = JointPath::new(&program, &robot).unwrap();
        let gravity = path.dynamics(MotionIndex::new(0)).gravity_m_s2();
        assert!((0..3).all(|i| (gravity[i] - self.gravity_m_s2[i]).abs() < 1e-9), "{gravity:?}");
        path
    }
}

/// Returns all cases of `fixtures/reference/torque.json`.
///
/// # Panics
///
/// Panics if the file is missing, or has another format.
#[must_use]
pub fn cases() -> Vec<TorqueCase> {
    let text = std::fs::read_to_string(fixture("reference/torque.json")).unwrap();
    serde_json::from_str::<TorqueCases>(&text).unwrap().cases
}
