//! What is known of a robot from recordings.

use iiwa_kin::Robot;

use crate::{
    estimate::Estimate,
    identify::{
        found_ramps::FoundRamps,
        found_torques::FoundTorques,
        kappa::Kappa,
        observation::{
            BlendObservation, CourseObservation, LeftOut, LineObservation, TcpBlendObservation,
        },
    },
};

/// What is known of a robot from recordings. Angles are in rad.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Identified {
    /// Limits of speed, in rad/s, of the joints that show theirs.
    pub velocity_rad_s: [Option<Estimate>; 7],
    /// Limits of acceleration, in rad/s^2.
    pub acceleration_rad_s2: [Option<Estimate>; 7],
    /// Limits of jerk, in rad/s^3.
    pub jerk_rad_s3: [Option<Estimate>; 7],
    /// The law of the ramps, if motions have ramps that begin with constant snap.
    pub ramps: Option<FoundRamps>,
    /// The time to settle.
    pub settle: Option<Settle>,
    /// kappa over gamma.
    pub kappa: Option<Kappa>,
    /// By what share blends begin and end where a program without Algorithm 3 would put them: 0 if they
    /// begin and end at equal distances, 1 if they do not.
    pub unequal_share: Option<Estimate>,
    /// All motions along lines.
    pub lines: Vec<LineObservation>,
    /// All blends.
    pub blends: Vec<BlendObservation>,
    /// kappa over gamma of blends between straight ways of the TCP.
    pub tcp_kappa: Option<Kappa>,
    /// How far before and behind their targets such blends begin and end, as shares of the program's `cart_mm`: of those
    /// that neither the half of a motion nor the other side makes smaller.
    pub tcp_reach: Option<[Estimate; 2]>,
    /// By what share they begin and end where each side by itself would put them: 0 if they begin and end at equal ways,
    /// 1 if they do not.
    pub tcp_unequal_share: Option<Estimate>,
    /// All blends between straight ways of the TCP.
    pub tcp_blends: Vec<TcpBlendObservation>,
    /// All paths of the TCP and the blends at their ends, against what is assumed of them, with kappa as found.
    pub courses: Vec<CourseObservation>,
    /// Loads and friction, if any recording has torques.
    pub torques: Option<FoundTorques>,
    /// The recordings, from 0, whose torques were not used, and why.
    pub unused_torques: Vec<(usize, &'static str)>,
    /// What the recordings have that was not used, and why.
    pub left_out: Vec<LeftOut>,
}

/// The time to settle (Larsen 2019, Table 6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settle {
    /// Its mean, in s.
    pub mean_s: Estimate,
    /// Standard deviation of the observations, in s.
    pub deviation_s: f64,
}

impl Identified {
    /// `model` with all that was found.
    #[must_use]
    pub fn robot(&self, model: &Robot) -> Robot {
        let mut limits = *model.limits();
        for (limits, found) in [
            (&mut limits.velocity_rad_s, &self.velocity_rad_s),
            (&mut limits.acceleration_rad_s2, &self.acceleration_rad_s2),
            (&mut limits.jerk_rad_s3, &self.jerk_rad_s3),
        ] {
            for (limit, found) in limits.iter_mut().zip(found) {
                *limit = found.map_or(*limit, |found| found.value);
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

/// Robots that do not settle do so for this long, in s.
const SHORTEST_SETTLE_S: f64 = 0.001;
