//! Joint torque limits.

use iiwa_kin::{Dynamics, Joint, Joints, PathTorques};
use iiwa_path::{JointPath, Segment, Step};
use iiwa_solver::{PathRow, RowLimit};

use crate::{
    limit::Limit,
    path_limit::{MAX_RAD, PathLimit},
    timing::TimingError,
};

/// Largest share of a torque limit that holding the arm may use. A plan with less torque left for
/// motion would be useless.
const MAX_HELD: f64 = 0.99;

/// Torque limits set by a program.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TorqueLimit;

/// Joint torques with the payload of a step, over their limits.
#[derive(Debug)]
struct TorqueRows {
    dynamics: Dynamics,
    inverse: Joints,
}

/// Returns the torque limits of a motion, and the friction at its velocity limits, in Nm. None if
/// the program does not limit torques.
///
/// Viscous friction is evaluated at the velocity limit: as a function of the squared speed it is
/// not convex, and it is below 1 % of the torque of an iiwa.
fn torque_bounds_nm(path: &JointPath, step: usize, dynamics: &Dynamics) -> Option<[Joints; 2]> {
    let limits_nm = path.torque_limits_nm()?;
    let friction_nm = dynamics.friction().torques_nm(path.limits_of(step).velocity_rad_s());
    Some([limits_nm, friction_nm])
}

impl PathLimit for TorqueLimit {
    fn of_step(&self, path: &JointPath, step: usize) -> Option<Box<dyn RowLimit>> {
        path.torque_limit_rel()?;
        let dynamics = path.dynamics(path.steps()[step].motion());
        let [limits_nm, friction_nm] = torque_bounds_nm(path, step, &dynamics)?;
        let inverse = std::array::from_fn(|j| 1.0 / (limits_nm[j] - friction_nm[j]));
        Some(Box::new(TorqueRows { dynamics, inverse }))
    }

    fn limit(&self, row: usize) -> Limit {
        Limit::Torque(Joint::ALL[row])
    }

    /// Checks that the joints can hold the arm and its payload everywhere on the path.
    fn check(&self, path: &JointPath) -> Result<(), TimingError> {
        if path.torque_limits_nm().is_none() {
            return Ok(());
        }
        for (step, entry) in path.steps().iter().enumerate() {
            let motion = entry.motion();
            let dynamics = path.dynamics(motion);
            let Some([limits_nm, friction_nm]) = torque_bounds_nm(path, step, &dynamics) else {
                return Ok(());
            };
            let check = |joints_rad: &Joints| {
                let holding_nm = dynamics.gravity_torques(joints_rad);
                let is_held = |j: &usize| {
                    holding_nm[*j].abs() <= MAX_HELD * (limits_nm[*j] - friction_nm[*j])
                };
                match Joint::ALL.into_iter().find(|joint| !is_held(&joint.index())) {
                    None => Ok(()),
                    Some(joint) => Err(TimingError::CannotHold {
                        motion,
                        joint,
                        holding_nm: holding_nm[joint.index()],
                        friction_nm: friction_nm[joint.index()],
                        limit_nm: limits_nm[joint.index()],
                    }),
                }
            };
            match entry {
                Step::Move { segment, .. } => {
                    places(segment.as_ref()).try_for_each(|q| check(&q))?;
                }
                // A program that begins with a rest has no segment that contains its start.
                _ if step == 0 => check(path.start_rad())?,
                _ => {}
            }
        }
        Ok(())
    }
}

/// Returns joint positions along a segment, including both ends.
fn places(segment: &dyn Segment) -> impl Iterator<Item = Joints> + '_ {
    // At least the ends and the middle; at most a number that bounds the time for any path.
    let parts = (segment.sigma_length_rad() / MAX_RAD).ceil().clamp(2.0, 1e4);
    let shares = (0_u32..).map(f64::from).take_while(move |k| *k <= parts);
    shares.map(move |k| segment.at(k / parts).q)
}

impl RowLimit for TorqueRows {
    fn row_count(&self) -> usize {
        7
    }

    fn rows(
        &self,
        joints_rad: &[Joints],
        derivative: &[Joints],
        second_derivative: &[Joints],
    ) -> Vec<PathRow> {
        let mut places = vec![PathTorques::default(); joints_rad.len()];
        self.dynamics.path_torques_batch(joints_rad, derivative, second_derivative, &mut places);
        let row = |torques: &PathTorques, j: usize| PathRow {
            acceleration: torques.acceleration[j] * self.inverse[j],
            square: torques.speed[j] * self.inverse[j],
            offset: torques.gravity[j] * self.inverse[j],
        };
        places.iter().flat_map(|torques| (0..7).map(move |j| row(torques, j))).collect()
    }

    /// Computes the shares in one pass of inverse dynamics instead of three.
    fn shares(
        &self,
        joints_rad: &[Joints],
        velocity_rad_s: &[Joints],
        acceleration_rad_s2: &[Joints],
    ) -> Vec<f64> {
        let mut torques = vec![[0.0; 7]; joints_rad.len()];
        self.dynamics.torques_batch(joints_rad, velocity_rad_s, acceleration_rad_s2, &mut torques);
        let share = |torques: &Joints, j: usize| torques[j] * self.inverse[j];
        torques.iter().flat_map(|torques| (0..7).map(move |j| share(torques, j))).collect()
    }
}

#[cfg(test)]
mod tests {
    use iiwa_kin::Robot;
    use iiwa_program::Program;

    use super::*;

    fn path(percent: &str, motions: &str) -> JointPath {
        let text = format!(
            r#"{{ "version": 1, {percent} "start": {{ "joints_deg": [0, 90, 0, 0, 0, 0, 0] }},
               "motions": [{motions}] }}"#
        );
        JointPath::new(&Program::from_json(&text).unwrap(), &Robot::default()).unwrap()
    }

    const WAIT: &str = r#"{ "type": "wait", "seconds": 1 }"#;
    const UP: &str = r#"{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0] }"#;

    /// With the arm stretched out, joint 2 has the largest holding torque.
    #[test]
    fn the_start_has_to_be_held() {
        for motions in [WAIT.to_owned(), UP.to_owned(), format!("{WAIT}, {UP}")] {
            let check = |percent: &str| TorqueLimit.check(&path(percent, &motions));
            let Err(TimingError::CannotHold { motion, joint, holding_nm, limit_nm, .. }) =
                check(r#""limit_torque_percent": 10,"#)
            else {
                unreachable!("{motions}")
            };
            assert_eq!((motion.index(), joint), (0, Joint::ALL[1]), "{motions}");
            assert!(holding_nm.abs() > limit_nm && (limit_nm - 17.6).abs() < 1e-12);
            assert!(check(r#""limit_torque_percent": 90,"#).is_ok() && check("").is_ok());
        }
    }

    #[test]
    fn rows_are_the_torques_of_the_motion() {
        let path = path(r#""limit_torque_percent": 50,"#, UP);
        let rows = TorqueLimit.of_step(&path, 0).unwrap();
        let q = [0.3, 0.7, -0.4, -1.1, 0.2, 0.9, 0.1];
        let first = [0.5, -0.3, 0.4, 0.2, -0.6, 0.7, 0.1];
        let second = [-0.2, 0.4, 0.3, -0.5, 0.1, 0.2, -0.3];
        let dynamics = path.dynamics(path.steps()[0].motion());
        let friction_nm = dynamics.friction().torques_nm(path.limits_of(0).velocity_rad_s());
        let limits_nm = Robot::default().limits().torque_nm.map(|limit| 0.5 * limit);
        for (speed, acceleration) in [(0.0, 0.0), (1.5, 0.0), (0.0, -2.0), (0.8, 3.0)] {
            let velocity: Joints = first.map(|d| d * speed);
            let by = |j: usize| first[j] * acceleration + second[j] * speed * speed;
            let acceleration_rad_s2: Joints = std::array::from_fn(by);
            let mut torques_nm = [[0.0; 7]];
            dynamics.torques_batch(&[q], &[velocity], &[acceleration_rad_s2], &mut torques_nm);
            let actual = rows.rows(&[q], &[first], &[second]);
            let shares = rows.shares(&[q], &[velocity], &[acceleration_rad_s2]);
            for j in 0..7 {
                let expected = torques_nm[0][j] / (limits_nm[j] - friction_nm[j]);
                let row = actual[j].at(speed, acceleration);
                assert!((row - expected).abs() < 1e-9, "{j}: {row} {expected}");
                assert!((shares[j] - expected).abs() < 1e-9, "{j}: {} {expected}", shares[j]);
            }
        }
    }
}
