//! Which torques the joints may exert along the steps of a path.

use std::ops::Range;

use iiwa_kin::{Dynamics, Joint, Joints};
use iiwa_path::{JointPath, Segment, Step};
use iiwa_solver::TorqueLimits;

use crate::{section::Section, state::State, timing::TimingError};

/// Share of what a joint may exert that holding the arm may take. With less left to move it, no plan would be of use.
const MOST_HELD: f64 = 0.99;

/// No joint turns by more between two places or instants at which torques are looked at, in rad.
const MOST_RAD: f64 = 0.05;

/// The most that the joints may exert in a motion, in Nm: less by what friction takes at its speed limits. None if the
/// program does not limit torques.
///
/// Viscous friction grows with the speed, which is no convex limit of its square; and it is below 1 % of an iiwa's torque.
fn most_nm(path: &JointPath, step: usize, dynamics: &Dynamics) -> Option<[Joints; 2]> {
    let limits_nm = path.torque_limits_nm()?;
    let friction_nm = dynamics.friction().torques_nm(path.limits_of(step).velocity_rad_s());
    Some([limits_nm, friction_nm])
}

/// The limits of the steps in `steps`, one for each. None if the program does not limit torques.
pub(crate) fn torque_limits(path: &JointPath, steps: Range<usize>) -> Option<Vec<TorqueLimits>> {
    steps
        .map(|step| {
            let motion = path.steps()[step].motion();
            let dynamics = path.dynamics(motion);
            let [limits_nm, friction_nm] = most_nm(path, step, &dynamics)?;
            let most_nm = std::array::from_fn(|j| limits_nm[j] - friction_nm[j]);
            Some(TorqueLimits::new(dynamics, &most_nm))
        })
        .collect()
}

/// Checks that the joints can hold the arm with its load wherever the path goes, if torques are limited.
pub(crate) fn check_holding(path: &JointPath) -> Result<(), TimingError> {
    if path.torque_limits_nm().is_none() {
        return Ok(());
    }
    for (step, entry) in path.steps().iter().enumerate() {
        let motion = entry.motion();
        let dynamics = path.dynamics(motion);
        let Some([limits_nm, friction_nm]) = most_nm(path, step, &dynamics) else { return Ok(()) };
        let check = |joints_rad: &Joints| {
            let holding_nm = dynamics.gravity_torques(joints_rad);
            let is_held =
                |j: &usize| holding_nm[*j].abs() <= MOST_HELD * (limits_nm[*j] - friction_nm[*j]);
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
            Step::Move { segment, .. } => places(segment.as_ref()).try_for_each(|q| check(&q))?,
            _ if step == 0 => check(path.start_rad())?,
            _ => {}
        }
    }
    Ok(())
}

/// The joints at places along a segment, its ends among them.
fn places(segment: &dyn Segment) -> impl Iterator<Item = Joints> + '_ {
    let parts = (segment.sigma_length_rad() / MOST_RAD).ceil().clamp(2.0, 1e4);
    let shares = (0_u32..).map(f64::from).take_while(move |k| *k <= parts);
    shares.map(move |k| segment.at(k / parts).q)
}

/// The largest share of a limit of torque that a section reaches; `limits` are those of its moves, of which the first is
/// `first_step`.
///
/// It is looked for where nodes begin and, if acceleration jumps there, where they end.
pub(crate) fn largest_torque(
    section: &Section,
    first_step: usize,
    limits: &[TorqueLimits],
    jumps: bool,
) -> f64 {
    if jumps {
        largest_at(&[0.0, 1.0], section, first_step, limits)
    } else {
        largest_at(&[0.0], section, first_step, limits)
    }
}

fn largest_at<const N: usize>(
    shares: &[f64; N],
    section: &Section,
    first_step: usize,
    limits: &[TorqueLimits],
) -> f64 {
    let mut largest = 0.0;
    for piece in section.pieces().iter().filter(|piece| piece.kind.moves()) {
        let limits = &limits[piece.step - first_step];
        let spans = section.spans_of(piece, shares, MOST_RAD);
        let states: Vec<_> = spans.flat_map(|(_, states)| states).collect();
        let all = |of: fn(&State) -> Joints| states.iter().map(of).collect::<Vec<_>>();
        let [q, dq, ddq] = [all(|state| state.q), all(|state| state.dq), all(|state| state.ddq)];
        for torque in limits.torques(&q, &dq, &ddq).as_flattened() {
            // What is not a number is above any limit.
            largest = if torque.abs() <= largest { largest } else { torque.abs() };
        }
    }
    largest
}
