//! Durations, cross-validated against TOPP-RA: the implementation of the crate `copp`, on the same
//! grid and under the same limits.
//!
//! The two agree to the first order in the length of an interval only: TOPP-RA holds d2s/dt2
//! within each one, and the sweep lets it change linearly. So the grid has to be fine.

use copp::{robot::Robot as CoppRobot, solver::topp2_ra as ra};
use iiwa_kin::{Joints, Robot};
use iiwa_path::{JointPath, Segment, Step};
use iiwa_program::MotionLimits;
use iiwa_traj::{SweepOptions, Timing, Trajectory};
use iiwasim_tests::reference::cases;
use nalgebra::DMatrix;

/// Intervals a segment for most programs, and for those where that is too coarse for TOPP-RA.
const INTERVALS: usize = 4000;
const MANY_INTERVALS: usize = 16_000;

/// A section from stop to stop on a grid, as TOPP-RA wants it.
#[derive(Default)]
struct Grid {
    /// Path parameter with a tangent of length 1 at all joins, in rad.
    sigma: Vec<f64>,
    dq: Vec<Joints>,
    ddq: Vec<Joints>,
    velocity: Vec<Joints>,
    acceleration: Vec<Joints>,
}

impl Grid {
    fn add(&mut self, segment: &dyn Segment, limits: &MotionLimits, intervals: usize) {
        let tangent = segment.tangent_lengths_rad()[0];
        let start = self.sigma.last().copied().unwrap_or(0.0);
        let first = usize::from(!self.sigma.is_empty());
        if first == 1 {
            // Where two motions meet, both limits hold.
            let lower = |a: &mut Joints, b: &Joints| {
                *a = std::array::from_fn(|j| a[j].min(b[j]));
            };
            lower(self.velocity.last_mut().unwrap(), limits.velocity_rad_s());
            lower(self.acceleration.last_mut().unwrap(), limits.acceleration_rad_s2());
        }
        for i in first..=intervals {
            let s = i as f64 / intervals as f64;
            let point = segment.at(s);
            self.sigma.push(start + s * tangent);
            self.dq.push(point.dq.map(|v| v / tangent));
            self.ddq.push(point.ddq.map(|v| v / (tangent * tangent)));
            self.velocity.push(*limits.velocity_rad_s());
            self.acceleration.push(*limits.acceleration_rad_s2());
        }
    }

    fn duration_s(&self) -> f64 {
        let n = self.sigma.len();
        if n == 0 {
            return 0.0;
        }
        let matrix = |rows: &[Joints]| DMatrix::from_column_slice(7, n, rows.as_flattened());
        let (q, dq, ddq) = (DMatrix::zeros(7, n), matrix(&self.dq), matrix(&self.ddq));
        let (v, a) = (matrix(&self.velocity), matrix(&self.acceleration));
        let mut robot = CoppRobot::<usize>::with_capacity(7, n);
        robot
            .with_s(self.sigma.as_slice())
            .unwrap()
            .with_q(&q.as_view(), &dq.as_view(), &ddq.as_view(), None, 0)
            .unwrap()
            .with_axial_velocity(&v.as_view(), &(-&v).as_view(), 0)
            .unwrap()
            .with_axial_acceleration(&a.as_view(), &(-&a).as_view(), 0)
            .unwrap();
        let problem = ra::Topp2ProblemBuilder::new(&robot, (0, n - 1), (0.0, 0.0)).build().unwrap();
        // Next to a stop the square of the speed is far below the default tolerances.
        let options = ra::ReachSet2OptionsBuilder::new()
            .a_cmp_abs_tol(1e-13)
            .a_cmp_rel_tol(1e-12)
            .lp_feas_tol(1e-12)
            .build()
            .unwrap();
        let x = ra::topp2_ra(&problem, &options).unwrap();
        ra::s_to_t_topp2(&self.sigma, &x, 0.0).unwrap().0
    }
}

fn topp_ra_s(path: &JointPath, intervals: usize) -> f64 {
    let mut total = 0.0;
    let mut grid = Grid::default();
    for step in path.steps() {
        match step {
            Step::Move { motion, segment, .. } => {
                grid.add(segment.as_ref(), &path.limits()[motion.index()], intervals);
            }
            _ => total += std::mem::take(&mut grid).duration_s(),
        }
    }
    total + grid.duration_s()
}

#[test]
fn durations_equal_those_of_topp_ra() {
    let mut worst = 0.0_f64;
    for case in cases() {
        let path = JointPath::new(&case.program, &Robot::lbr_iiwa_7_r800()).unwrap();
        let intervals = if case.id == 8 { MANY_INTERVALS } else { INTERVALS };
        let timing = Timing::Acceleration(SweepOptions { samples: intervals });
        let actual_s = Trajectory::plan(&path, timing).unwrap().motion_time_s();
        let expected = topp_ra_s(&path, intervals);
        let difference = actual_s / expected - 1.0;
        println!(
            "program {:2}: {actual_s:.6} s, TOPP-RA {expected:.6} s, \
            {difference:+.2e}",
            case.id
        );
        worst = worst.max(difference.abs());
    }
    assert!(worst < 1e-4, "{worst:e}");
}
