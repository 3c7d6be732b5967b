//! Programs of the experiments of the thesis (Larsen 2019, sections 4.2 and 5.1.2, Appendices A, B
//! and C), and of two further ones: [`tcp_blends()`], about TCP motions, and [`load`](load()),
//! about the effect of a payload. The thesis names both as future work.
//!
//! Random programs are reproducible by their seed. All programs keep the flange above the plane of
//! the robot base; other obstacles are not considered.

mod load;
mod load_effect;
mod tcp_blends;
mod trial;

use fastrand::Rng;
use iiwa_kin::{
    Joints, Robot,
    vector::{norm, sub},
};
use iiwa_program::{Blend, Ptp};

use self::trial::program;

pub use self::{
    load::{LoadSwing, load, load_swings},
    load_effect::{LoadEffect, LoadVerdict, SwingEffect},
    tcp_blends::{TcpSeries, tcp_blends},
    trial::Trial,
};

/// Larsen 2019, Table 3, in degrees.
const POSES_DEG: [Joints; 20] = [
    [-44.91, 27.72, 96.85, 49.32, -97.77, 71.79, 65.26],
    [4.06, -13.72, -145.50, -81.72, -40.66, -70.54, -103.57],
    [146.56, -3.80, -114.28, -99.07, -147.33, -24.42, 9.82],
    [21.36, 7.12, 32.15, -66.75, 48.91, -9.84, -45.84],
    [-132.89, 7.54, 85.00, 60.52, 5.96, -39.61, 116.55],
    [68.00, 31.91, 127.72, 7.87, -107.30, -7.58, -82.05],
    [108.67, -20.33, 83.90, 68.73, 149.04, 99.94, 34.56],
    [-32.27, -16.37, -60.82, 68.03, -142.88, -24.83, -126.29],
    [53.16, -31.06, -147.36, 83.76, -67.23, -45.42, 27.25],
    [57.35, 23.63, 67.95, -3.01, -88.39, 48.75, -9.78],
    [-12.61, 31.44, 73.33, -78.34, 29.71, -22.95, 72.85],
    [32.69, 5.07, -41.60, -69.69, -82.47, -14.97, 93.89],
    [5.13, 34.30, 75.46, -30.89, -99.31, 31.46, -2.51],
    [-130.94, 13.98, 1.44, -70.50, 134.88, -71.68, 125.59],
    [57.87, -13.79, -22.03, -85.92, 139.98, 36.64, -107.50],
    [113.18, 22.52, 24.61, -61.73, -96.63, 63.44, -7.67],
    [-103.33, 0.27, 69.61, -18.88, -66.13, 13.75, 56.49],
    [76.76, 15.53, -7.41, -75.40, -39.66, 66.94, -144.12],
    [5.10, 11.41, -22.13, -79.06, 134.80, 84.28, 15.36],
    [-46.20, -1.98, -37.51, 69.40, -54.94, -8.78, -70.71],
];

/// Swing of the joints to either side of a pose in Appendix A, in degrees.
const SWING_DEG: f64 = 20.0;

/// Swing about zero, in degrees: joints 6 and 7 do not reach full speed within 40 deg.
const WIDE_SWING_DEG: f64 = 70.0;

/// Creates programs for the joint limits (Appendix A): from 20 poses, each joint swings separately
/// by 20 deg to either side at full speed. A last program swings the joints by 70 deg about zero,
/// since joints 6 and 7 need more than 40 deg to reach full speed.
#[must_use]
pub fn limits() -> Vec<Trial> {
    let swings = |pose_deg: Joints, swing_deg: f64| {
        let start_rad = rad(pose_deg);
        let joints = (0..7).flat_map(|j| {
            [-swing_deg, swing_deg, 0.0].map(|swing_deg| {
                let mut target_deg = pose_deg;
                target_deg[j] += swing_deg;
                Ptp::to(rad(target_deg))
            })
        });
        program(start_rad, joints)
    };
    let poses = POSES_DEG.iter().enumerate().map(|(i, pose_deg)| Trial {
        name: format!("pose-{:02}", i + 1),
        program: swings(*pose_deg, SWING_DEG),
    });
    let wide = Trial { name: "wide".to_owned(), program: swings([0.0; 7], WIDE_SWING_DEG) };
    poses.chain([wide]).collect()
}

/// Start of the second motions of section 4.2, and lengths of both motions, in degrees. The lengths
/// differ, so that the effect of Algorithm 3 is visible; the thesis states neither.
const CORNER_DEG: Joints = [0.0, 30.0, 0.0, -70.0, 0.0, 60.0, 0.0];
const FIRST_LEG_DEG: f64 = 40.0;
const SECOND_LEG_DEG: f64 = 25.0;

/// Creates the program for the blend curve (section 4.2): a corner with a relative blend of 0.25,
/// followed by 36 targets on a circle. Only joints 2 and 4 move, at `velocity_rel` of full speed.
#[must_use]
pub fn blends(velocity_rel: f64) -> Trial {
    let about_corner = |deg: f64, angle_deg: f64| {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let mut target_deg = CORNER_DEG;
        target_deg[1] += deg * cos;
        target_deg[3] += deg * sin;
        rad(target_deg)
    };
    let start_rad = about_corner(FIRST_LEG_DEG, 180.0);
    let motions = (0..36).flat_map(|i| {
        let corner = Ptp::to(rad(CORNER_DEG)).blend(Blend::Fraction(0.25));
        let end = about_corner(SECOND_LEG_DEG, f64::from(i) * 10.0);
        [corner, Ptp::to(end), Ptp::to(start_rad)].map(|motion| motion.velocity(velocity_rel))
    });
    Trial { name: "circle".to_owned(), program: program(start_rad, motions) }
}

/// Creates the program for the velocity in blends (Appendix B), unchanged.
#[must_use]
pub fn zone_velocity() -> Trial {
    let to = |[a2, a4, a6]: [f64; 3]| Ptp::to([0.0, a2, 0.0, a4, 0.0, a6, 0.0]);
    let motions = [
        to([-0.337_023, -0.984_366, 1.685_115]).blend(Blend::CartMm(200.0)).velocity(0.75),
        to([-0.474_031, -1.991_944, 1.531_526]).blend(Blend::CartMm(50.0)).velocity(0.1),
        to([0.739_496, -0.778_068, 1.578_825]).blend(Blend::CartMm(100.0)).velocity(0.5),
        to([1.110_378, -1.156_979, 0.895_354]).velocity(0.2),
    ];
    Trial { name: "appendix-b".to_owned(), program: program([0.0; 7], motions) }
}

/// Creates the program for the settle time (Appendix C): `count` random points at random speeds
/// without blends; the thesis has 200.
#[must_use]
pub fn settle(robot: &Robot, count: usize, seed: u64) -> Trial {
    let mut random = Rng::with_seed(seed);
    let mut pose_rad = HOME_RAD;
    let motions: Vec<_> = (0..count)
        .map(|_| {
            pose_rad = random_target(robot, &mut random, &pose_rad, |random| {
                let (middle, half) = ranges(robot);
                std::array::from_fn(|j| middle[j] + 0.6 * half[j] * symmetric(random))
            });
            Ptp::to(pose_rad).velocity(0.1 + 0.9 * random.f64())
        })
        .collect();
    Trial { name: "settle".to_owned(), program: program(HOME_RAD, motions) }
}

/// Parameter that is varied to examine the cycle time (section 5.1.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sweep {
    /// Relative velocity (Fig. 23).
    Velocity,
    /// Relative blend (Fig. 24).
    Blend,
    /// Path length (Fig. 25).
    Length,
}

/// Program of section 5.1.2: ten motions in random directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleTimeCase {
    /// Index of the random path, from 0.
    pub path: u64,
    /// `v_%`: share of full speed.
    pub velocity_rel: f64,
    /// `b_%`: share of the motions that is blended; 0 for no blends.
    pub blend: f64,
    /// lambda: length of each motion, the norm of the joint displacements, in degrees. The thesis
    /// does not define its lambda; this definition matches the motion lengths suggested by its
    /// cycle times.
    pub length_deg: f64,
}

impl Sweep {
    /// All parameters.
    pub const ALL: [Self; 3] = [Self::Velocity, Self::Blend, Self::Length];

    /// Returns the cases: one for each value and each of the five random paths. The other
    /// parameters are those of the thesis: velocity 0.4, blend 0.25, length 200.
    #[must_use]
    pub fn cases(self) -> Vec<CycleTimeCase> {
        let values: &[f64] = match self {
            Self::Velocity => &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0],
            Self::Blend => &[0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5],
            Self::Length => &[25.0, 50.0, 75.0, 100.0, 125.0, 150.0, 175.0, 200.0],
        };
        let case = |path: u64, value: f64| {
            let thesis = CycleTimeCase { path, velocity_rel: 0.4, blend: 0.25, length_deg: 200.0 };
            match self {
                Self::Velocity => CycleTimeCase { velocity_rel: value, ..thesis },
                Self::Blend => CycleTimeCase { blend: value, ..thesis },
                Self::Length => CycleTimeCase { length_deg: value, ..thesis },
            }
        };
        let of_value = |value: &f64| (0..5).map(|path| case(path, *value)).collect::<Vec<_>>();
        values.iter().flat_map(of_value).collect()
    }
}

impl CycleTimeCase {
    /// Creates the program.
    #[must_use]
    pub fn trial(&self, robot: &Robot, seed: u64) -> Trial {
        let Self { path, velocity_rel, blend, length_deg } = *self;
        let mut random = Rng::with_seed(seed.wrapping_mul(1000).wrapping_add(path));
        let mut pose_rad = HOME_RAD;
        let mut motions: Vec<_> = (0..10)
            .map(|_| {
                let from = pose_rad;
                pose_rad = random_target(robot, &mut random, &from, |random| {
                    // Uniform distribution over all directions.
                    let way: Joints = std::array::from_fn(|_| normal(random));
                    let scale = length_deg.to_radians() / norm(&way);
                    std::array::from_fn(|j| from[j] + scale * way[j])
                });
                let motion = Ptp::to(pose_rad).velocity(velocity_rel);
                if blend > 0.0 { motion.blend(Blend::Fraction(blend)) } else { motion }
            })
            .collect();
        if let Some(last) = motions.last_mut() {
            last.blend = None;
        }
        let name = format!(
            "path-{}-velocity-{:03.0}-blend-{:02.0}-length-{length_deg:03.0}",
            path + 1,
            100.0 * velocity_rel,
            100.0 * blend
        );
        Trial { name, program: program(HOME_RAD, motions) }
    }
}

/// Start of random programs, in rad: elbow and wrist bent.
const HOME_RAD: Joints = [0.0, 0.5, 0.0, -1.2, 0.0, 0.8, 0.0];

/// Minimum height of the flange above the robot base, in m.
const CLEARANCE_M: f64 = 0.1;

/// Share of the joint ranges that targets use: blends may overshoot.
const RANGE_SHARE: f64 = 0.9;

/// Draws targets until one can be reached from `from`.
fn random_target(
    robot: &Robot,
    random: &mut Rng,
    from: &Joints,
    draw: impl Fn(&mut Rng) -> Joints,
) -> Joints {
    loop {
        let to = draw(random);
        let (middle, half) = ranges(robot);
        let way = sub(&to, from);
        let above = |i: u32| {
            let share = f64::from(i) / 16.0;
            let q: Joints = std::array::from_fn(|j| from[j] + share * way[j]);
            robot.flange_position(&q)[2] > CLEARANCE_M
        };
        if (0..7).all(|j| (to[j] - middle[j]).abs() <= RANGE_SHARE * half[j]) && (1..=16).all(above)
        {
            return to;
        }
    }
}

/// Returns the centre and the half-width of each joint range, in rad.
fn ranges(robot: &Robot) -> (Joints, Joints) {
    let limits = robot.limits();
    let step = |sign: f64| {
        std::array::from_fn(|j| 0.5 * (limits.upper_rad[j] + sign * limits.lower_rad[j]))
    };
    (step(1.0), step(-1.0))
}

/// Draws a number from a uniform distribution between -1 and 1.
fn symmetric(random: &mut Rng) -> f64 {
    2.0 * random.f64() - 1.0
}

fn normal(random: &mut Rng) -> f64 {
    use fastrand_contrib::RngExt as _;
    random.f64_normal(0.0, 1.0)
}

fn rad(deg: Joints) -> Joints {
    deg.map(f64::to_radians)
}

#[cfg(test)]
mod tests {
    use iiwa_path::JointPath;
    use iiwa_program::Motion;

    use super::*;

    #[test]
    fn all_programs_can_be_planned() {
        let robot = Robot::default();
        let mut trials = limits();
        trials.extend([blends(0.5), zone_velocity(), settle(&robot, 200, 1)]);
        for sweep in Sweep::ALL {
            trials.extend(sweep.cases().iter().map(|case| case.trial(&robot, 1)));
        }
        trials.push(tcp_blends(&TcpSeries::ALL));
        for Trial { name, program } in trials {
            JointPath::new(&program, &robot).unwrap_or_else(|fault| panic!("{name}: {fault}"));
        }
    }

    #[test]
    fn lengths_are_as_requested() {
        let case = CycleTimeCase { path: 3, velocity_rel: 0.4, blend: 0.25, length_deg: 200.0 };
        let Trial { name, program } = case.trial(&Robot::default(), 1);
        assert_eq!(name, "path-4-velocity-040-blend-25-length-200");
        let mut pose_rad = *program.start.joints_rad().unwrap();
        for motion in &program.motions {
            let Motion::Ptp(ptp) = motion else { panic!("a wait") };
            assert!((norm(&sub(&ptp.target_rad, &pose_rad)).to_degrees() - 200.0).abs() < 1e-9);
            pose_rad = ptp.target_rad;
        }
    }
}
