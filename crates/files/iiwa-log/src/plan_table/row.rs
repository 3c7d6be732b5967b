//! Row of a plan table.

use iiwa_traj::{MotionDynamics, Section};

/// Time since the start, number of the motion, and all further columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlanRow {
    pub(super) t_s: f64,
    pub(super) motion: usize,
    /// Values in the order of [`names`].
    pub(super) values: [f64; 34],
}

/// Names of all columns but the first two.
pub(super) fn names() -> impl Iterator<Item = String> {
    let joints = |unit| (1..=7).map(move |joint| format!("joint_{joint}_{unit}"));
    let tcp = ["x_m", "y_m", "z_m", "a_rad", "b_rad", "c_rad"];
    ["rad", "rad_s", "rad_s2"]
        .into_iter()
        .flat_map(joints)
        .chain(tcp.map(|name| format!("tcp_{name}")))
        .chain((1..=7).map(|joint| format!("torque_{joint}_nm")))
}

impl PlanRow {
    /// Returns the row at a time.
    pub(super) fn at(section: &Section, t_s: f64, dynamics: &mut MotionDynamics) -> Self {
        let state = section.at(t_s);
        let path = section.path();
        let tcp = path.robot().flange_pose(&state.q).then(path.tcp(state.motion));
        let mut values = [0.0; 34];
        let torque_nm = dynamics.torque_nm(section, &state);
        let parts: [&[f64]; 6] =
            [&state.q, &state.dq, &state.ddq, &tcp.position_m, &tcp.abc_rad(), &torque_nm];
        for (value, part) in values.iter_mut().zip(parts.into_iter().flatten()) {
            *value = *part;
        }
        Self { t_s, motion: state.motion.number(), values }
    }
}
