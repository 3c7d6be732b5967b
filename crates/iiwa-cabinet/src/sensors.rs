//! Simulated sensors.

use iiwa_kin::{Joints, Robot};

/// Room temperature, in degrees Celsius.
const ROOM_C: f64 = 25.0;
/// Final temperature rise of a joint that always moves at full speed, in K.
const HEATING_K: f64 = 25.0;
/// Time constant of warming up, in s.
const WARMING_S: f64 = 900.0;
/// Acceleration of gravity, in m/s^2.
const GRAVITY: f64 = 9.81;

/// Joint temperatures, heated by motion and cooled by the air. The model is plausible, not measured.
#[derive(Clone, Debug)]
pub(crate) struct Temperatures(Joints);

impl Temperatures {
    pub(crate) fn new() -> Self {
        Self([ROOM_C; 7])
    }

    /// Advances by `dt_s` at velocities given as shares of the limits.
    pub(crate) fn advance(&mut self, speed_rel: &Joints, dt_s: f64) {
        for (temperature, speed) in self.0.iter_mut().zip(speed_rel) {
            let target = ROOM_C + HEATING_K * speed.abs();
            *temperature += (target - *temperature) * dt_s / WARMING_S;
        }
    }

    /// In degrees Celsius.
    pub(crate) fn celsius(&self) -> Joints {
        self.0
    }
}

/// Joint torques that hold the weight of a floor-mounted arm, in Nm. Each link is a point mass half-way between
/// its ends: an estimate, as are the masses.
pub(crate) fn holding_torques(robot: &Robot, joints_rad: &Joints) -> Joints {
    let links = robot.link_poses(joints_rad);
    let masses = robot.link_mass_kg();
    std::array::from_fn(|j| {
        // Joint j turns link j + 1 and all that follow, about the z axis of that link's frame.
        let joint = &links[j + 1];
        let axis = joint.rotation.map(|row| row[2]);
        (j + 1..8)
            .map(|link| {
                let lever: [f64; 2] = std::array::from_fn(|i| {
                    0.5 * (links[link].position_m[i] + links[link + 1].position_m[i])
                        - joint.position_m[i]
                });
                // Torque of the weight about the axis.
                masses[link] * GRAVITY * (axis[0] * lever[1] - axis[1] * lever[0])
            })
            .sum()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holding_torques_are_the_slope_of_the_weights_heights() {
        let robot = Robot::lbr_iiwa_7_r800();
        let energy = |q: &Joints| -> f64 {
            let links = robot.link_poses(q);
            let height = |i: usize| 0.5 * (links[i].position_m[2] + links[i + 1].position_m[2]);
            (1..8).map(|i| robot.link_mass_kg()[i] * GRAVITY * height(i)).sum()
        };
        let q = [0.3, 0.7, -0.4, -1.1, 0.5, 0.9, 0.2];
        let torques = holding_torques(&robot, &q);
        for j in 0..7 {
            let [mut more, mut less] = [q, q];
            more[j] += 1e-5;
            less[j] -= 1e-5;
            let slope = (energy(&more) - energy(&less)) / 2e-5;
            assert!((torques[j] - slope).abs() < 1e-6, "joint {}: {} {slope}", j + 1, torques[j]);
        }
        assert!(torques[1].abs() > 1.0);
    }

    #[test]
    fn joints_that_move_get_warmer() {
        let mut temperatures = Temperatures::new();
        for _ in 0..600 {
            temperatures.advance(&[1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0);
        }
        let [a1, a2, a3, ..] = temperatures.celsius();
        assert!(a1 > a2 && a2 > a3 && a3 == ROOM_C && a1 < ROOM_C + HEATING_K);
    }
}
