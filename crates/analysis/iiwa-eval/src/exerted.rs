//! Sign of recorded torques.

use iiwa_kin::{Dynamics, Joints};
use iiwa_log::JointLog;

/// Returns the torques exerted by the joints, in Nm, sample by sample, and true if their sign was
/// inverted because it is not that of the format: KUKA's controller measures the opposite sign of
/// plans, and other recorders invert it. `None` without torques.
///
/// Gravity reveals the sign: the recorded torques correlate positively with the gravity torques of
/// `arm`, in the robot's mounting position, for any payload.
pub(crate) fn exerted(log: &JointLog, arm: &Dynamics) -> Option<(Vec<Option<Joints>>, bool)> {
    let mut torques: Vec<_> = log.exerted_nm().collect();
    let known = log.q_rad.iter().zip(&torques);
    let known = known.filter_map(|(q, torque)| Some((q, (*torque)?)));
    // A few hundred samples are sufficient.
    let thinned = torques.len().div_ceil(500).max(1);
    let alike = known.step_by(thinned).map(|(q, torque)| -> f64 {
        let weight = arm.gravity_torques(q);
        weight.iter().zip(torque).map(|(weight, torque)| weight * torque).sum()
    });
    let alike = alike.reduce(|sum, product| sum + product)?;
    let turned = alike < 0.0;
    if turned {
        for nm in torques.iter_mut().flatten().flatten() {
            *nm = 0.0 - *nm;
        }
    }
    Some((torques, turned))
}
