//! Simulated torque sensors.

use iiwa_kin::{Dynamics, Joints, Load, Mount, Robot};
use iiwa_path::JointPath;
use iiwa_program::MotionIndex;

use crate::noise::Noise;

/// Joint motion at an instant.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JointMotion {
    pub(crate) velocity_rad_s: Joints,
    pub(crate) acceleration_rad_s2: Joints,
}

/// Sensor reading, in Nm, with the sign of KUKA's controller: the load on a joint, opposite to the
/// torque that the joint exerts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TorqueReading {
    pub(crate) measured_nm: Joints,
    /// Torque that the configured payload does not explain.
    pub(crate) external_nm: Joints,
}

/// Torque sensors of a robot. The actual payload may differ from the configured one.
#[derive(Clone, Debug)]
pub(crate) struct TorqueSensors {
    /// Dynamics on the floor, without payload.
    empty: Dynamics,
    /// Actual payload and mounting, regardless of the programs.
    load: Option<Load>,
    mount: Option<Mount>,
    /// Payload and mounting of the last program.
    said: (Option<Load>, Mount),
    real: Dynamics,
    configured: Dynamics,
    noise: Noise,
}

/// Differs from the seed of the position noise.
const NOISE_SEED: u64 = 2;

impl TorqueSensors {
    /// Creates sensors of a robot without configuration, with noise of a standard deviation in Nm.
    /// Without `load` and `mount`, payload and mounting are taken from the programs.
    pub(crate) fn new(
        robot: &Robot,
        load: Option<Load>,
        mount: Option<Mount>,
        noise_nm: f64,
    ) -> Self {
        let empty = robot.dynamics();
        let noise = Noise::new(noise_nm, NOISE_SEED);
        let mut sensors = Self {
            empty,
            load,
            mount,
            said: Default::default(),
            real: empty,
            configured: empty,
            noise,
        };
        sensors.set(None, Mount::default());
        sensors
    }

    /// Configures the controller with the payload and mounting that a program states for a motion.
    pub(crate) fn configure(&mut self, path: &JointPath, motion: MotionIndex) {
        let (load, mount) = (path.load(motion), path.mount());
        if self.said.0.as_ref() != load || self.said.1 != *mount {
            self.set(load, *mount);
        }
    }

    fn set(&mut self, load: Option<&Load>, mount: Mount) {
        let with = |load: Option<&Load>| {
            let standing = self.empty.with_mount(&self.mount.unwrap_or(mount));
            load.map_or(standing, |load| standing.with_load(load))
        };
        let (configured, real) = (with(load), with(self.load.as_ref().or(load)));
        (self.configured, self.real) = (configured, real);
        self.said = (load.copied(), mount);
    }

    /// Returns the sensor reading.
    pub(crate) fn read(&mut self, joints_rad: &Joints, motion: &JointMotion) -> TorqueReading {
        let JointMotion { velocity_rad_s, acceleration_rad_s2 } = motion;
        let torques = |arm: &Dynamics| arm.torques(joints_rad, velocity_rad_s, acceleration_rad_s2);
        let real = torques(&self.real);
        let expected = if self.real == self.configured { real } else { torques(&self.configured) };
        let friction = self.empty.friction().torques_nm(velocity_rad_s);
        let measured_nm: Joints =
            std::array::from_fn(|j| self.noise.next() - real[j] - friction[j]);
        let external_nm = std::array::from_fn(|j| measured_nm[j] + expected[j]);
        TorqueReading { measured_nm, external_nm }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASIDE: Joints = [0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0];

    fn load(mass_kg: f64) -> Load {
        Load { mass_kg, center_mm: [0.0, 0.0, 100.0], ..Load::default() }
    }

    #[test]
    fn external_torques_are_those_of_unconfigured_loads() {
        let robot = Robot::default();
        let still = JointMotion::default();
        let mut sensors = TorqueSensors::new(&robot, Some(load(3.0)), None, 0.0);
        let reading = sensors.read(&ASIDE, &still);
        // 1.052 m from the shoulder. A torque towards larger A2 angles is positive.
        assert!((reading.external_nm[1] - 3.0 * 9.81 * 1.052).abs() < 1e-9);
        let expected = -robot.dynamics().with_load(&load(3.0)).gravity_torques(&ASIDE)[1];
        assert!((reading.measured_nm[1] - expected).abs() < 1e-12);

        sensors.set(Some(&load(3.0)), Mount::default());
        assert_eq!(sensors.read(&ASIDE, &still).external_nm, [0.0; 7]);
        sensors.set(Some(&load(4.0)), Mount::default());
        assert!((sensors.read(&ASIDE, &still).external_nm[1] + 9.81 * 1.052).abs() < 1e-9);
    }

    #[test]
    fn programs_do_not_change_the_mounting() {
        let ceiling = Mount::from_rpy_deg([180.0, 0.0, 0.0]);
        let mut sensors = TorqueSensors::new(&Robot::default(), None, Some(ceiling), 0.0);
        let hanging = sensors.read(&ASIDE, &JointMotion::default()).measured_nm[1];
        sensors.set(None, Mount::default());
        assert_eq!(sensors.read(&ASIDE, &JointMotion::default()).measured_nm[1], hanging);
        assert!(hanging < -60.0, "{hanging}");
    }

    #[test]
    fn noise_scatters_as_much_as_it_is_set_to() {
        let mut sensors = TorqueSensors::new(&Robot::default(), None, None, 0.1);
        let squares: f64 = (0..1000)
            .flat_map(|_| sensors.read(&ASIDE, &JointMotion::default()).external_nm)
            .map(|nm| nm * nm)
            .sum();
        let deviation = (squares / 7000.0).sqrt();
        assert!((deviation - 0.1).abs() < 0.005, "{deviation}");
    }
}
