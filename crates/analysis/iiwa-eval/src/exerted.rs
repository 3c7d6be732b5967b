//! Which sign recorded torques have.

use iiwa_kin::{Dynamics, Joints};
use iiwa_log::JointLog;

/// What the joints exert, in Nm, sample by sample, and whether the file has that sign already: other recorders turn what
/// KUKA's controller measures. None if it has no torques.
///
/// Weight tells: the torques of `arm`, which stands as the robot does, have the same sign, whatever it carries.
pub(crate) fn exerted(log: &JointLog, arm: &Dynamics) -> Option<(Vec<Option<Joints>>, bool)> {
    let mut torques: Vec<_> = log.exerted_nm().collect();
    let known = log.q_rad.iter().zip(&torques);
    let known = known.filter_map(|(q, torque)| Some((q, (*torque)?)));
    // A few hundred are enough.
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
