//! Result of the identification of a robot.

use iiwa_kin::{Joint, Robot};

use crate::{
    estimate::Estimate,
    identify::{
        kappa::Kappa,
        observation::{
            BlendObservation, CourseObservation, LeftOut, LineObservation, TcpBlendObservation,
        },
        ramp_estimates::RampEstimates,
        torque_estimates::TorqueEstimates,
    },
};

/// Result of the identification of a robot. Angles are in rad.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Identified {
    /// Velocity limits, in rad/s, of the joints whose limits the recordings show.
    pub velocity_rad_s: [Option<Estimate>; 7],
    /// Acceleration limits, in rad/s^2.
    pub acceleration_rad_s2: [Option<Estimate>; 7],
    /// Jerk limits, in rad/s^3.
    pub jerk_rad_s3: [Option<Estimate>; 7],
    /// Ramp law, if motions have ramps that begin with constant snap.
    pub ramps: Option<RampEstimates>,
    /// Settle time.
    pub settle: Option<Settle>,
    /// kappa over gamma.
    pub kappa: Option<Kappa>,
    /// Position of the start and end of blends relative to a planner without Algorithm 3: 0 if they
    /// are at equal distances from the target, 1 if they are where that planner would put them.
    pub unequal_share: Option<Estimate>,
    /// All motions along lines.
    pub lines: Vec<LineObservation>,
    /// All blends.
    pub blends: Vec<BlendObservation>,
    /// kappa over gamma of blends between straight TCP paths.
    pub tcp_kappa: Option<Kappa>,
    /// Distances of the start and the end of such blends from their targets, as shares of the
    /// program's `cart_mm`: only blends that are not shortened by half of a motion or by the other
    /// side.
    pub tcp_reach: Option<[Estimate; 2]>,
    /// Position of the start and end of such blends relative to independent sides: 0 if both are at
    /// equal distances from the target, 1 if each is where its side alone would put it.
    pub tcp_unequal_share: Option<Estimate>,
    /// All blends between straight TCP paths.
    pub tcp_blends: Vec<TcpBlendObservation>,
    /// All TCP paths and the blends at their ends, compared with the assumptions about them, with
    /// the identified kappa.
    pub courses: Vec<CourseObservation>,
    /// Payloads and friction, if any recording has torques.
    pub torques: Option<TorqueEstimates>,
    /// Indices, from 0, of the recordings whose torques were not used, and the reason.
    pub unused_torques: Vec<(usize, &'static str)>,
    /// Parts of the recordings that were not used, and the reason.
    pub left_out: Vec<LeftOut>,
}

/// Settle time (Larsen 2019, Table 6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settle {
    /// Mean, in s.
    pub mean_s: Estimate,
    /// Standard deviation of the observations, in s.
    pub deviation_s: f64,
}

impl Identified {
    /// Returns `model` with all identified values. The values that the recordings do not show are
    /// those of the model, and are added to its [assumptions](Robot::assumptions).
    #[must_use]
    pub fn robot(&self, model: &Robot) -> Robot {
        let mut limits = *model.limits();
        for (limits, estimates) in [
            (&mut limits.velocity_rad_s, &self.velocity_rad_s),
            (&mut limits.acceleration_rad_s2, &self.acceleration_rad_s2),
            (&mut limits.jerk_rad_s3, &self.jerk_rad_s3),
        ] {
            for (limit, estimates) in limits.iter_mut().zip(estimates) {
                *limit = estimates.map_or(*limit, |estimates| estimates.value);
            }
        }
        let mut robot = model.clone().with_limits(limits);
        if let Some(ramps) = &self.ramps {
            let law = ramps.law(model.ramp_law());
            robot = robot.with_ramp_law(law);
        }
        if let Some(settle) = &self.settle {
            robot = robot.with_settle_time_s(settle.mean_s.value.max(SHORTEST_SETTLE_S));
        }
        if let Some(kappa) = &self.kappa {
            robot = robot.with_blend_kappa(*kappa.coefficients());
        }
        if let Some(kappa) = &self.tcp_kappa {
            robot = robot.with_tcp_blend_kappa(*kappa.coefficients());
        }
        if let Some(torques) = &self.torques {
            let friction = torques.friction(model.friction());
            robot = robot.with_friction(friction);
        }
        let basis = format!("not shown by the recordings; taken from {}", model.name());
        for quantity in self.missing() {
            robot = robot.with_assumption(quantity, &*basis);
        }
        robot
    }

    /// Quantities that the recordings do not show.
    fn missing(&self) -> Vec<String> {
        let joints = |estimates: &[Option<Estimate>; 7]| -> Vec<String> {
            let estimates = Joint::ALL.into_iter().zip(estimates);
            estimates.filter(|(_, it)| it.is_none()).map(|(joint, _)| joint.to_string()).collect()
        };
        let mut by_joint = vec![
            ("velocity", joints(&self.velocity_rad_s)),
            ("acceleration", joints(&self.acceleration_rad_s2)),
            ("jerk", joints(&self.jerk_rad_s3)),
        ];
        if let Some(ramps) = &self.ramps {
            by_joint.extend([
                ("ramp snap", joints(&ramps.torque_snap_nm_s2)),
                ("start ramps", joints(&ramps.start_nm_s)),
                ("stop ramps", joints(&ramps.stop_nm_s)),
            ]);
        }
        if let Some(torques) = &self.torques {
            by_joint.extend([
                ("viscous friction", joints(&torques.viscous_nm_s_rad)),
                ("Coulomb friction", joints(&torques.coulomb_nm)),
            ]);
        }
        let by_joint = by_joint.into_iter().filter(|(_, joints)| !joints.is_empty());
        let by_joint = by_joint.map(|(quantity, joints)| match joints.len() {
            7 => format!("{quantity} of all joints"),
            _ => format!("{quantity} of {}", joints.join(", ")),
        });
        let others = [
            ("ramps of all joints", self.ramps.is_none()),
            ("settling time", self.settle.is_none()),
            ("blend curve", self.kappa.is_none()),
            ("blend curve of TCP paths", self.tcp_kappa.is_none() && self.kappa.is_none()),
            ("friction", self.torques.is_none()),
        ];
        let others = others.into_iter().filter(|(_, missing)| *missing);
        by_joint.chain(others.map(|(quantity, _)| quantity.to_owned())).collect()
    }
}

/// Minimum settle time of an identified robot, in s.
const SHORTEST_SETTLE_S: f64 = 0.001;
