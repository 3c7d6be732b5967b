//! Joint torques, energies and mass matrix of a robot with its payload.

use crate::{
    Friction, Joints, Load, Mount, RigidBody, Robot,
    forward::sin_cos_of_joints,
    newton_euler::{Linkage, holding, inverse_dynamics, mass_matrix},
    rigid_body::Moments,
    rotation::{self, Vec3},
    vector,
};

/// Equations of motion of a robot, `torque = M(q) q'' + C(q, q') q' + g(q)`, for the torques that
/// the joints exert.
///
/// A torque is positive if it turns its joint in the positive direction. Torques are on the output
/// side of the gears, where the iiwa has its torque sensors, and exclude rotor inertia and motor
/// friction. Joint friction is kept separately in [`Dynamics::friction`].
///
/// ```
/// use iiwa_kin::{Load, Robot};
///
/// // Stretched sideways, so that A2 holds the whole arm.
/// let robot = Robot::lbr_iiwa_7_r800();
/// let aside = [0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let empty = robot.dynamics();
/// assert!((empty.gravity_torques(&aside)[1] + 65.3).abs() < 0.05);
///
/// // A payload of 1 kg, 100 mm beyond the flange and 1.052 m from the shoulder.
/// let load = Load { mass_kg: 1.0, center_mm: [0.0, 0.0, 100.0], ..Load::default() };
/// let more = empty.with_load(&load).gravity_torques(&aside)[1] - empty.gravity_torques(&aside)[1];
/// assert!((more + 9.81 * 1.052).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dynamics {
    pub(crate) arm: Linkage,
    friction: Friction,
}

/// Components of the joint torques along a path q(s):
/// `acceleration * s'' + speed * s'^2 + gravity`, each the torques of the seven joints in Nm (s in
/// any unit, its time derivatives per s and s^2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathTorques {
    /// `M(q) dq/ds`, the factor of the path acceleration.
    pub acceleration: Joints,
    /// `M(q) d2q/ds2 + C(q, dq/ds) dq/ds`, the factor of the squared path speed.
    pub speed: Joints,
    /// `g(q)`, independent of the path speed.
    pub gravity: Joints,
}

impl PathTorques {
    /// Joint torques, in Nm, at path speed s' and path acceleration s''.
    #[must_use]
    pub fn at(&self, speed: f64, acceleration: f64) -> Joints {
        std::array::from_fn(|j| {
            self.acceleration[j] * acceleration + self.speed[j] * speed * speed + self.gravity[j]
        })
    }
}

impl Robot {
    /// Equations of motion of this robot, mounted on the floor, without payload.
    #[must_use]
    pub fn dynamics(&self) -> Dynamics {
        let links = self.carried_links();
        let arm = Linkage {
            links: std::array::from_fn(|j| Moments::from(&links[j])),
            offsets: self.offsets(),
            rest: [0.0; 3],
        };
        Dynamics { arm, friction: *self.friction() }.with_mount(&Mount::default())
    }
}

impl Dynamics {
    /// Adds a payload to those already attached. The payload is merged into the last link, so it
    /// does not add to the computing time of a torque.
    #[must_use]
    pub fn with_load(self, load: &Load) -> Self {
        self.with_body(&load.body())
    }

    /// Adds a rigid body given in the flange frame, as [`with_load`](Self::with_load) does with a
    /// payload.
    #[must_use]
    pub fn with_body(mut self, body: &RigidBody) -> Self {
        let [.., flange] = self.arm.offsets;
        let last = &mut self.arm.links[6];
        *last = last.plus(&Moments::from(body).shifted(flange));
        self
    }

    /// Sets the mounting: floor, wall, ceiling or any slope.
    #[must_use]
    pub fn with_mount(self, mount: &Mount) -> Self {
        self.with_gravity_m_s2(mount.gravity_m_s2())
    }

    /// Sets the gravity vector in the base frame, in m/s^2.
    #[must_use]
    pub fn with_gravity_m_s2(mut self, gravity_m_s2: [f64; 3]) -> Self {
        self.arm.rest = gravity_m_s2.map(|g| -g);
        self
    }

    /// Gravity vector in the base frame, in m/s^2.
    #[must_use]
    pub fn gravity_m_s2(&self) -> [f64; 3] {
        self.arm.rest.map(|g| -g)
    }

    /// Joint friction, which is not part of any torque of this type.
    #[must_use]
    pub fn friction(&self) -> &Friction {
        &self.friction
    }

    /// Inverse dynamics: joint torques, in Nm, at joint positions in rad, velocities in rad/s and
    /// accelerations in rad/s^2; without friction.
    ///
    /// Recursive Newton-Euler algorithm (Luh, Walker and Paul 1980). Cross-validated against
    /// Pinocchio 4.1.0 within 1e-9 Nm.
    #[must_use]
    pub fn torques(
        &self,
        joints_rad: &Joints,
        velocity_rad_s: &Joints,
        acceleration_rad_s2: &Joints,
    ) -> Joints {
        let (s, c) = sin_cos_of_joints(joints_rad);
        inverse_dynamics::<true>(&self.arm, [&s, &c], velocity_rad_s, acceleration_rad_s2)
    }

    /// Joint torques, in Nm, that hold the robot at rest against gravity: `g(q)`.
    #[must_use]
    pub fn gravity_torques(&self, joints_rad: &Joints) -> Joints {
        let (s, c) = sin_cos_of_joints(joints_rad);
        holding(&self.arm, [&s, &c])
    }

    /// Torque components at a point of a path q(s), from the joint positions, dq/ds and d2q/ds2.
    ///
    /// ```
    /// let dynamics = iiwa_kin::Robot::default().dynamics();
    /// let (q, dq, ddq) = ([0.3; 7], [0.1, -0.2, 0.3, 0.4, -0.5, 0.6, 0.7], [0.2; 7]);
    /// let parts = dynamics.path_torques(&q, &dq, &ddq);
    /// // At s' = 2 and s'' = 5.
    /// let velocity = dq.map(|v| 2.0 * v);
    /// let acceleration = std::array::from_fn(|j| 5.0 * dq[j] + 4.0 * ddq[j]);
    /// let (found, expected) =
    ///     (parts.at(2.0, 5.0), dynamics.torques(&q, &velocity, &acceleration));
    /// assert!((0..7).all(|j| (found[j] - expected[j]).abs() < 1e-12));
    /// ```
    #[must_use]
    pub fn path_torques(
        &self,
        joints_rad: &Joints,
        derivative: &Joints,
        second_derivative: &Joints,
    ) -> PathTorques {
        let (s, c) = sin_cos_of_joints(joints_rad);
        path_torques(&self.arm, [&s, &c], derivative, second_derivative)
    }

    /// The mass matrix M(q), in kg m^2.
    #[must_use]
    pub fn mass_matrix(&self, joints_rad: &Joints) -> [Joints; 7] {
        let (s, c) = sin_cos_of_joints(joints_rad);
        mass_matrix(&self.arm, [&s, &c])
    }

    /// Kinetic energy, in J, of the links and the payload, without the rotors.
    #[must_use]
    pub fn kinetic_energy_j(&self, joints_rad: &Joints, velocity_rad_s: &Joints) -> f64 {
        let momenta = self.mass_matrix(joints_rad).map(|row| vector::dot(&row, velocity_rad_s));
        0.5 * vector::dot(&momenta, velocity_rad_s)
    }

    /// Potential energy, in J; 0 if all masses were at the origin of the base frame.
    #[must_use]
    pub fn potential_energy_j(&self, joints_rad: &Joints) -> f64 {
        let Linkage { links, offsets, rest } = &self.arm;
        let (s, c) = sin_cos_of_joints(joints_rad);
        let mut frame = crate::forward::FrameAxes::BASE;
        let mut moment: Vec3<f64> = [0.0; 3];
        for (j, link) in links.iter().enumerate() {
            frame.turn(s[j], c[j]);
            let [x, y, z] = link.first_kg_m;
            for (i, sum) in moment.iter_mut().enumerate() {
                *sum +=
                    link.mass_kg * frame.p[i] + (frame.x[i] * x + frame.y[i] * y + frame.z[i] * z);
            }
            frame.step(j, offsets);
        }
        rotation::dot(rest, &moment)
    }
}

#[expect(
    clippy::inline_always,
    reason = "it must be inlined into what enables vector instructions"
)]
#[inline(always)]
pub(crate) fn path_torques(
    arm: &Linkage,
    sin_cos: [&Joints; 2],
    derivative: &Joints,
    second_derivative: &Joints,
) -> PathTorques {
    PathTorques {
        acceleration: inverse_dynamics::<false>(arm, sin_cos, &[0.0; 7], derivative),
        speed: inverse_dynamics::<false>(arm, sin_cos, derivative, second_derivative),
        gravity: holding(arm, sin_cos),
    }
}
