//! Peer: time parameterisation with velocity, acceleration and jerk limits by the third-order
//! solvers of the crate `copp`. Each of their steps solves a convex problem, with the jerk limits
//! linearised about the speeds of the last step.

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

/// Distance between a join and the nodes next to it, relative to an interval.
///
/// The third derivative jumps at a join, and the solver has one value of it per node: so each side
/// has its own node. A larger distance leaves part of the path unchecked and gives shorter times.
const JOIN_GAP: f64 = 1.0 / 32.0;

/// Units of the solver: with these, the limits are of the order of one.
const UNIT_RAD: f64 = 0.5;
const UNIT_S: f64 = 0.25;

/// Stopping criteria: the relative change of the duration in the last step, and the maximum number
/// of steps.
const SETTLED: f64 = 1e-4;
const MAX_STEPS: usize = 10;

/// Objective of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// Largest mean square of the speed, by a linear program: nearly the shortest time.
    Linear,
    /// Shortest time, by a second-order cone program.
    Conic,
}

/// Configuration of the peer.
#[derive(Clone, Copy, Debug)]
pub struct Peer {
    /// Name in benches and tables.
    pub name: &'static str,
    /// Objective of its steps.
    pub solver: Solver,
    /// Intervals per segment.
    pub intervals: usize,
    /// `true` if its time is measured: a solution with many intervals takes seconds, and a bench
    /// needs ten.
    pub timed: bool,
}

/// Both solvers, with few and with many intervals.
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

/// Result of the solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// Time in motion, in s.
    pub duration_s: f64,
    /// Number of steps.
    pub iterations: usize,
}

/// Path from its start to its first stop, sampled: derivatives by the distance along the path, and
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
    /// Samples `path` at `intervals` equal intervals per segment, with narrow ones at the joins and
    /// a separate one at each stop.
    ///
    /// # Errors
    ///
    /// An error if the arm stops before the path's last segment, since the peer does not support
    /// stops.
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

    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.distance.len()
    }

    /// Solves the problem by steps from the solution without jerk limits, until the duration
    /// converges.
    ///
    /// # Errors
    ///
    /// An error if the solver rejects the samples, or a step finds no solution.
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
            if iterations == MAX_STEPS || (before / duration - 1.0).abs() < SETTLED {
                return Ok(Solution { duration_s: duration * UNIT_S, iterations });
            }
            squared_speed = profile.a;
        }
    }

    /// Distance from the start to each node, in the solver's units.
    fn distance(&self) -> Vec<f64> {
        self.distance.iter().map(|s| s / UNIT_RAD).collect()
    }

    /// Problem of the solver, in its units.
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
        // Only torque limits depend on positions.
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
    // Near a stop the square of the speed is far below the default tolerances.
    let options = ra::ReachSet2OptionsBuilder::new()
        .a_cmp_abs_tol(1e-13)
        .a_cmp_rel_tol(1e-12)
        .lp_feas_tol(1e-12)
        .build()?;
    ra::topp2_ra(&problem, &options)
}

/// Segment of the path.
struct Piece<'a> {
    /// Distance from the start of the path to that of the segment, in rad.
    start: f64,
    segment: &'a dyn Segment,
    limits: &'a MotionLimits,
}

impl Piece<'_> {
    /// Difference of the distance from `s`, relative to the length of the tangent, and its first
    /// three derivatives: alpha of Larsen 2019, Eq. 18 with N = 2, for polynomial blends.
    ///
    /// A polynomial blend mixes two lines, each as long as its tangent, and traverses both: with
    /// alpha, the distance is about as long as the blend. Alpha and its first two derivatives
    /// vanish at the ends, so the second derivative of the path remains continuous there.
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
        let point = self.segment.at(s);
        [
            point.dq.map(|q1| q1 * s1),
            std::array::from_fn(|j| point.ddq[j] * s1 * s1 + point.dq[j] * s2),
            std::array::from_fn(|j| {
                point.dddq[j] * s1.powi(3) + 3.0 * point.ddq[j] * s1 * s2 + point.dq[j] * s3
            }),
        ]
    }

    /// Distance from a stop at `s` over which the jerk may be at its limit until the acceleration
    /// reaches its own limit, relative to the piece.
    ///
    /// Near a stop the solver keeps the jerk constant for one interval. Any other length costs
    /// time: also a shorter one, since the jerk is lower within the next few intervals.
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

    /// The times of the independent solver are lower bounds, and these are upper bounds: they keep
    /// the limits at both ends of each interval, which costs time in proportion to its length.
    #[test]
    fn durations_come_down_to_those_of_an_independent_solver() {
        let program = Program::from_json(&reference::ten_motions().unwrap()).unwrap();
        let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap();
        let expected = reference::ten_motions_jerk_s().unwrap();
        for (intervals, tolerance) in [(20, 0.035), (50, 0.015)] {
            let samples = JerkSamples::new(&path, intervals).unwrap();
            let conic = samples.solve(Solver::Conic).unwrap();
            let linear = samples.solve(Solver::Linear).unwrap();
            println!(
                "{intervals} intervals a segment, reference {expected} s: {conic:?} {linear:?}"
            );
            let above = conic.duration_s / expected - 1.0;
            assert!(above > 0.0 && above < tolerance, "{above}");
            assert!(conic.iterations < MAX_STEPS && linear.iterations < MAX_STEPS);
            // The linear solver has another objective, so its time is no shorter.
            let above = linear.duration_s / conic.duration_s - 1.0;
            assert!(above > 0.0 && above < 0.002, "{above}");
        }
    }
}
