//! Peer: time stamps under limits of velocity, acceleration and jerk by the third-order solvers of
//! the crate `copp`. Each of their steps solves a convex problem, with the limits of jerk
//! linearised about the last step's speeds.

use copp::{
    diag::CoppError,
    robot::Robot,
    solver::{topp2_ra as ra, topp3_lp as lp, topp3_socp as socp},
};
use iiwa_kin::Joints;
use iiwa_path::{JointPath, Segment, Step};
use iiwa_program::MotionLimits;
use nalgebra::DMatrix;

use super::Result;

/// The distance of the nodes next to a join from it, as a share of an interval.
///
/// The third derivative jumps there, and the solver knows one of it a node: so each side has its
/// own node. A larger share leaves part of the path unchecked and makes for shorter times.
const JOIN_GAP: f64 = 1.0 / 32.0;

/// Units that the solver counts in: in these, the limits are of the order of one.
const UNIT_RAD: f64 = 0.5;
const UNIT_S: f64 = 0.25;

/// When to stop: the relative change of the duration in the last step, and how many steps at most.
const SETTLED: f64 = 1e-4;
const MOST_STEPS: usize = 10;

/// What a step looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// The greatest mean square of the speed, by a linear program: nearly the shortest time.
    Linear,
    /// The shortest time, by a second-order cone program.
    Conic,
}

/// One way to use the peer.
#[derive(Clone, Copy, Debug)]
pub struct Peer {
    /// What benches and tables call it.
    pub name: &'static str,
    /// What its steps look for.
    pub solver: Solver,
    /// Intervals a segment.
    pub intervals: usize,
    /// Whether its time is measured: a solution at many intervals takes seconds, a bench ten.
    pub timed: bool,
}

/// Both solvers, at few and at many intervals.
pub const PEERS: [Peer; 4] = [
    Peer {
        name: "copp topp3_lp, 20 intervals",
        solver: Solver::Linear,
        intervals: 20,
        timed: true,
    },
    Peer {
        name: "copp topp3_socp, 20 intervals",
        solver: Solver::Conic,
        intervals: 20,
        timed: true,
    },
    Peer {
        name: "copp topp3_lp, 100 intervals",
        solver: Solver::Linear,
        intervals: 100,
        timed: false,
    },
    Peer {
        name: "copp topp3_socp, 100 intervals",
        solver: Solver::Conic,
        intervals: 100,
        timed: true,
    },
];

/// What the solver finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// Time in motion, in s.
    pub duration_s: f64,
    /// Steps that it took.
    pub iterations: usize,
}

/// A path from its start to its first stop, sampled: derivatives by the distance along it, and
/// limits.
#[derive(Debug, Default)]
pub struct JerkSamples {
    distance: Vec<f64>,
    first: Vec<Joints>,
    second: Vec<Joints>,
    third: Vec<Joints>,
    velocity: Vec<Joints>,
    acceleration: Vec<Joints>,
    jerk: Vec<Joints>,
}

impl JerkSamples {
    /// Samples `path` at `intervals` even intervals a segment, but for narrow ones at the joins and
    /// one of its own at each stop.
    ///
    /// # Errors
    ///
    /// If the arm stops before the path's last segment: the peer has no notion of a stop.
    pub fn new(path: &JointPath, intervals: usize) -> Result<Self> {
        let count =
            path.steps().iter().take_while(|step| matches!(step, Step::Move { .. })).count();
        let (moves, rest) = path.steps().split_at(count);
        if rest.iter().any(|step| matches!(step, Step::Move { .. })) {
            return Err("the program stops in between".into());
        }
        let mut samples = Self::default();
        let mut start = 0.0;
        for (k, step) in moves.iter().enumerate() {
            let Step::Move { motion, segment, .. } = step else { continue };
            let piece =
                Piece { start, segment: segment.as_ref(), limits: &path.limits()[motion.index()] };
            let gap = JOIN_GAP / intervals as f64;
            let from = if k == 0 { piece.ramp(0.0) } else { gap };
            let to = 1.0 - if k + 1 == count { piece.ramp(1.0) } else { gap };
            if k == 0 {
                samples.push(&piece, 0.0);
            }
            for i in 0..=intervals {
                samples.push(&piece, from + (to - from) * i as f64 / intervals as f64);
            }
            if k + 1 == count {
                samples.push(&piece, 1.0);
            }
            start = piece.distance(1.0);
        }
        Ok(samples)
    }

    fn push(&mut self, piece: &Piece<'_>, s: f64) {
        let [first, second, third] = piece.derivatives(s);
        self.distance.push(piece.distance(s));
        self.first.push(first);
        self.second.push(second);
        self.third.push(third);
        self.velocity.push(*piece.limits.velocity_rad_s());
        self.acceleration.push(*piece.limits.acceleration_rad_s2());
        self.jerk.push(*piece.limits.jerk_rad_s3());
    }

    /// The number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.distance.len()
    }

    /// Solves it by steps from the solution without limits of jerk, until the duration settles.
    ///
    /// # Errors
    ///
    /// If the solver does not take the samples, or a step finds no solution.
    pub fn solve(&self, solver: Solver) -> std::result::Result<Solution, CoppError> {
        // The solver keeps the linearised limits in the problem: so each solution has its own.
        let mut robot = self.robot()?;
        let distance = self.distance();
        let mut squared_speed = without_jerk(&robot, distance.len() - 1)?;
        let mut duration = f64::INFINITY;
        let options = socp::ClarabelOptionsBuilder::new().build()?;
        let mut iterations = 0;
        loop {
            iterations += 1;
            let stop = (0.0, 0.0);
            let problem = socp::Topp3ProblemBuilder::new(&mut robot, 0, &squared_speed, stop, stop)
                .with_num_stationary_max(1)
                .build_with_linearization()?;
            let profile = match solver {
                Solver::Linear => lp::topp3_lp(&problem, &options)?,
                Solver::Conic => socp::topp3_socp(&problem, &options)?,
            };
            let before = duration;
            duration = socp::s_to_t_topp3(&distance, profile.as_parts(), 0.0)?.0;
            if iterations == MOST_STEPS || (before / duration - 1.0).abs() < SETTLED {
                return Ok(Solution { duration_s: duration * UNIT_S, iterations });
            }
            squared_speed = profile.a;
        }
    }

    /// Distance from the start to each node, in the solver's units.
    fn distance(&self) -> Vec<f64> {
        self.distance.iter().map(|s| s / UNIT_RAD).collect()
    }

    /// The solver's problem, in its units.
    fn robot(&self) -> std::result::Result<Robot<usize>, CoppError> {
        let n = self.nodes();
        let matrix = |rows: &[Joints], unit: f64| {
            DMatrix::from_column_slice(7, n, rows.as_flattened()) / unit
        };
        let first = matrix(&self.first, 1.0);
        let second = matrix(&self.second, 1.0 / UNIT_RAD);
        let third = matrix(&self.third, 1.0 / UNIT_RAD.powi(2));
        let velocity = matrix(&self.velocity, UNIT_RAD / UNIT_S);
        let acceleration = matrix(&self.acceleration, UNIT_RAD / UNIT_S.powi(2));
        let jerk = matrix(&self.jerk, UNIT_RAD / UNIT_S.powi(3));
        // Positions matter to limits of torque alone.
        let position = DMatrix::zeros(7, n);
        let mut robot = Robot::with_capacity(7, n);
        robot
            .with_s(&self.distance())?
            .with_q(
                &position.as_view(),
                &first.as_view(),
                &second.as_view(),
                Some(&third.as_view()),
                0,
            )?
            .with_axial_velocity(&velocity.as_view(), &(-&velocity).as_view(), 0)?
            .with_axial_acceleration(&acceleration.as_view(), &(-&acceleration).as_view(), 0)?
            .with_axial_jerk(&jerk.as_view(), &(-&jerk).as_view(), 0)?;
        Ok(robot)
    }
}

fn without_jerk(robot: &Robot<usize>, last: usize) -> std::result::Result<Vec<f64>, CoppError> {
    let problem = ra::Topp2ProblemBuilder::new(robot, (0, last), (0.0, 0.0)).build()?;
    // Next to a stop the square of the speed is far below the default tolerances.
    let options = ra::ReachSet2OptionsBuilder::new()
        .a_cmp_abs_tol(1e-13)
        .a_cmp_rel_tol(1e-12)
        .lp_feas_tol(1e-12)
        .build()?;
    ra::topp2_ra(&problem, &options)
}

/// A segment of the path.
struct Piece<'a> {
    /// Distance from the path's start to its own, in rad.
    start: f64,
    segment: &'a dyn Segment,
    limits: &'a MotionLimits,
}

impl Piece<'_> {
    /// What the distance has besides `s`, over the tangent's length, and its first three
    /// derivatives: alpha of Larsen 2019, Eq. 18 with N = 2, for polynomial blends.
    ///
    /// A polynomial blend mixes two lines, each as long as its tangent, and runs through both: with
    /// alpha, the distance is about as long as the blend. Alpha vanishes at the ends, up to its
    /// second derivative: so the path's second derivative stays continuous there.
    fn bend(&self, s: f64) -> [f64; 4] {
        if self.segment.is_straight() || !self.segment.has_continuous_curvature() {
            return [0.0; 4];
        }
        let t = 1.0 - s;
        [
            s * s * s * (10.0 - 15.0 * s + 6.0 * s * s),
            30.0 * s * s * t * t,
            60.0 * s * t * (t - s),
            60.0 * (1.0 - 6.0 * s * t),
        ]
    }

    fn distance(&self, s: f64) -> f64 {
        self.start + self.segment.tangent_lengths_rad()[0] * (s + self.bend(s)[0])
    }

    /// First three derivatives by the distance.
    fn derivatives(&self, s: f64) -> [Joints; 3] {
        let tangent = self.segment.tangent_lengths_rad()[0];
        let [_, bend1, bend2, bend3] = self.bend(s);
        let (p, r, w) = (1.0 + bend1, bend2, bend3);
        // Derivatives of s by the distance: those of an inverse function.
        let s1 = 1.0 / (p * tangent);
        let s2 = -r / (p.powi(3) * tangent.powi(2));
        let s3 = (3.0 * r * r - p * w) / (p.powi(5) * tangent.powi(3));
        let at = self.segment.at(s);
        [
            at.dq.map(|q1| q1 * s1),
            std::array::from_fn(|j| at.ddq[j] * s1 * s1 + at.dq[j] * s2),
            std::array::from_fn(|j| {
                at.dddq[j] * s1.powi(3) + 3.0 * at.ddq[j] * s1 * s2 + at.dq[j] * s3
            }),
        ]
    }

    /// How far from a stop at `s` the jerk may stay at its limit until the acceleration is at its
    /// own, as a share of the piece.
    ///
    /// Next to a stop the solver holds the jerk for one interval. Any other length costs time: a
    /// shorter one, since the jerk falls short within the next few intervals.
    fn ramp(&self, s: f64) -> f64 {
        let [first, ..] = self.derivatives(s);
        let along = |limits: &Joints| {
            limits.iter().zip(&first).map(|(l, v)| l / v.abs()).fold(f64::INFINITY, f64::min)
        };
        let acceleration = along(self.limits.acceleration_rad_s2());
        let jerk = along(self.limits.jerk_rad_s3());
        let way = acceleration.powi(3) / (6.0 * jerk * jerk);
        (way / self.segment.tangent_lengths_rad()[0]).min(0.25)
    }
}

#[cfg(test)]
mod tests {
    use iiwa_kin::Robot;
    use iiwa_program::Program;

    use super::super::reference;
    use super::*;

    /// The times of the independent solver are from below, and these are from above: they hold the
    /// limits at both ends of each interval, which costs time in proportion to its length.
    #[test]
    fn durations_come_down_to_those_of_an_independent_solver() {
        let program = Program::from_json(&reference::ten_motions().unwrap()).unwrap();
        let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap();
        let expected = reference::ten_motions_jerk_s().unwrap();
        for (intervals, most) in [(20, 0.035), (50, 0.015)] {
            let samples = JerkSamples::new(&path, intervals).unwrap();
            let conic = samples.solve(Solver::Conic).unwrap();
            let linear = samples.solve(Solver::Linear).unwrap();
            println!(
                "{intervals} intervals a segment, reference {expected} s: {conic:?} {linear:?}"
            );
            let above = conic.duration_s / expected - 1.0;
            assert!(above > 0.0 && above < most, "{above}");
            assert!(conic.iterations < MOST_STEPS && linear.iterations < MOST_STEPS);
            // It looks for something else, which is no shorter.
            let above = linear.duration_s / conic.duration_s - 1.0;
            assert!(above > 0.0 && above < 0.002, "{above}");
        }
    }
}
