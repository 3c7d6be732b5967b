//! Limits of the joints' torques.

use iiwa_kin::{Dynamics, Joint, Joints, PathTorques};
use iiwa_path::{JointPath, Segment, Step};
use iiwa_solver::{PathRow, RowLimit};

use crate::{
    limit::Limit,
    path_limit::{MOST_RAD, PathLimit},
    timing::TimingError,
};

/// Share of what a joint may exert that holding the arm may take. With less left to move it, no plan would be of use.
const MOST_HELD: f64 = 0.99;

/// The limits of torque that a program sets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TorqueLimit;

/// The torques of the joints with the load of a step, over their limits.
#[derive(Debug)]
struct TorqueRows {
    dynamics: Dynamics,
    inverse: Joints,
}

/// The torque limits of a motion, and the friction at its speed limits, in Nm. None if the program does not limit torques.
///
/// Viscous friction grows with the speed, which is no convex limit of its square; and it is below 1 % of an iiwa's torque.
fn most_nm(path: &JointPath, step: usize, dynamics: &Dynamics) -> Option<[Joints; 2]> {
    let limits_nm = path.torque_limits_nm()?;
    let friction_nm = dynamics.friction().torques_nm(path.limits_of(step).velocity_rad_s());
    Some([limits_nm, friction_nm])
}

impl PathLimit for TorqueLimit {
    fn of_step(&self, path: &JointPath, step: usize) -> Option<Box<dyn RowLimit>> {
        path.torque_limit_rel()?;
        let dynamics = path.dynamics(path.steps()[step].motion());
        let [limits_nm, friction_nm] = most_nm(path, step, &dynamics)?;
        let inverse = std::array::from_fn(|j| 1.0 / (limits_nm[j] - friction_nm[j]));
        Some(Box::new(TorqueRows { dynamics, inverse }))
    }

    fn limit(&self, row: usize) -> Limit {
        Limit::Torque(Joint::ALL[row])
    }

    /// Checks that the joints can hold the arm with its load wherever the path goes.
    fn check(&self, path: &JointPath) -> Result<(), TimingError> {
        if path.torque_limits_nm().is_none() {
            return Ok(());
        }
        for (step, entry) in path.steps().iter().enumerate() {
            let motion = entry.motion();
            let dynamics = path.dynamics(motion);
            let Some([limits_nm, friction_nm]) = most_nm(path, step, &dynamics) else {
                return Ok(());
            };
            let check = |joints_rad: &Joints| {
                let holding_nm = dynamics.gravity_torques(joints_rad);
                let is_held = |j: &usize| {
                    holding_nm[*j].abs() <= MOST_HELD * (limits_nm[*j] - friction_nm[*j])
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
                _ if step == 0 => check(path.start_rad())?,
                _ => {}
            }
        }
        Ok(())
    }
}

/// The joints at places along a segment, its ends among them.
fn places(segment: &dyn Segment) -> impl Iterator<Item = Joints> + '_ {
    let parts = (segment.sigma_length_rad() / MOST_RAD).ceil().clamp(2.0, 1e4);
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

    /// In one pass of inverse dynamics instead of three.
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
