//! Limits of the joints' torques.

use iiwa_kin::{Dynamics, Joints, PathTorques};

/// The arm with its load, and the torques that its joints may exert.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimits {
    dynamics: Dynamics,
    inverse: Joints,
}

impl TorqueLimits {
    /// The limits of an arm: the largest torque of each joint, either way, in Nm.
    #[must_use]
    pub fn new(dynamics: Dynamics, limit_nm: &Joints) -> Self {
        Self { dynamics, inverse: limit_nm.map(|limit| 1.0 / limit) }
    }

    /// What the torques at places of a path are made of, as shares of the limits: the joints there, and their first and
    /// second derivatives by the path parameter.
    #[must_use]
    pub fn shares(
        &self,
        joints_rad: &[Joints],
        derivative: &[Joints],
        second_derivative: &[Joints],
    ) -> Vec<PathTorques> {
        let mut places = vec![PathTorques::default(); joints_rad.len()];
        self.dynamics.path_torques_batch(joints_rad, derivative, second_derivative, &mut places);
        for PathTorques { acceleration, speed, gravity } in &mut places {
            for part in [acceleration, speed, gravity] {
                *part = std::array::from_fn(|j| part[j] * self.inverse[j]);
            }
        }
        places
    }

    /// The torques that move the arm, as shares of the limits: joints in rad, velocities in rad/s, accelerations in rad/s^2.
    #[must_use]
    pub fn torques(
        &self,
        joints_rad: &[Joints],
        velocity_rad_s: &[Joints],
        acceleration_rad_s2: &[Joints],
    ) -> Vec<Joints> {
        let mut torques = vec![[0.0; 7]; joints_rad.len()];
        self.dynamics.torques_batch(joints_rad, velocity_rad_s, acceleration_rad_s2, &mut torques);
        for torques in &mut torques {
            *torques = std::array::from_fn(|j| torques[j] * self.inverse[j]);
        }
        torques
    }
}
