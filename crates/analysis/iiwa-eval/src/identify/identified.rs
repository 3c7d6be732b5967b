//! Result of the identification of a robot.

use iiwa_kin::Robot;

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
    /// Returns `model` with all identified values.
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
        robot
    }
}

/// Minimum settle time of an identified robot, in s.
const SHORTEST_SETTLE_S: f64 = 0.001;
