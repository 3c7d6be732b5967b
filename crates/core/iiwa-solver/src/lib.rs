//! Time-optimal motion along a joint path under velocity, acceleration and jerk limits.
//!
//! The path parameter sigma, in rad, is the distance along a line in joint space; in blends, it is
//! chosen such that the first two derivatives of the path with respect to sigma are continuous. The
//! unknown, x = (dsigma/dt)^2, is a cubic on each cell of a [mesh](Mesh), except on the cells that
//! touch rest, in which jerk is constant. At some points of each cell, the limits become
//! constraints, called rows: one per joint for acceleration and for jerk, a single one for
//! velocity, which is that of the joint nearest to its limit. On lines, joints move in proportion,
//! so that one row each is sufficient for acceleration and for jerk. Rows of velocity and
//! acceleration are linear in x and its derivative. Jerk is sqrt(x) L, with L linear in x and its
//! first two derivatives: the limit |jerk| <= j is the row |L| / j <= 1/sqrt(x).
//!
//! A primal-dual interior-point method minimises the duration; each of its Newton steps is a
//! Riccati recursion. Between the points with rows, the solution may exceed a limit. The rows of
//! this cell are then tightened, and the cell is solved again with the cells around it.
//!
//! The input is segments, their limits, and an initial motion ([`SweptNode`]s), which should be
//! within the velocity and acceleration limits, since it determines the mesh and the initial values
//! of x. `iiwa-traj` builds trajectories from the solution.
//!
//! The example solves for a line, a blend and a line, from rest to rest, on a mesh of the usual
//! fineness, 1.0. In a `SweptNode`, `p` is the share of the segment's sigma, from 0 to 1, `rate` is
//! dp/dt, and `u` is d2p/dt2 at both ends of the interval to the next node.
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//!
//! use iiwa_kin::Robot;
//! use iiwa_path::{JointPath, Step};
//! use iiwa_program::{Blend, Program};
//! use iiwa_solver::{LimitedSegment, Solution, SweptNode, Window};
//!
//! let program = Program::from_deg([0.0; 7])
//!     .ptp_deg([20.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
//!     .blend(Blend::Fraction(0.5))
//!     .ptp_deg([20.0, 20.0, 0.0, 0.0, 0.0, 0.0, 0.0])
//!     .build();
//! let path = JointPath::new(&program, &Robot::default())?;
//! // Initial motion at constant speed, 1 s per segment. For brevity, its times start again at 0
//! // in each segment, whereas the times of a real one continue. Its speed jumps at rest and
//! // between segments, so that it exceeds the acceleration limits. In this example, the solver
//! // converges all the same.
//! let swept = [0.0, 0.5, 1.0].map(|p| SweptNode { t_s: p, p, rate: 1.0, u: [0.0; 2] });
//! let segments: Vec<_> = path
//!     .steps()
//!     .iter()
//!     .filter_map(|step| match step {
//!         Step::Move { segment, motion, .. } => {
//!             LimitedSegment::new(segment.as_ref(), &path.limits()[motion.index()], &swept)
//!         }
//!         _ => None,
//!     })
//!     .collect();
//! let window = Window { segments: &segments, range: 0..3, entry: None, exit: None };
//! let best = Solution::find(&window, 1.0, &AtomicBool::new(false))?;
//! assert!((0.5..0.8).contains(&best.duration_s()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![expect(
    clippy::inline_always,
    reason = "kernels must be inlined into the function that enables vector instructions"
)]
#![expect(clippy::needless_range_loop, reason = "several arrays are indexed by the same index")]

mod attempt;
mod blocks;
mod bounded_rows;
mod cell;
mod cell_functions;
mod cells;
mod geometry;
mod jerk_rows;
#[cfg(test)]
mod known_motion;
mod lanes;
mod limited_segment;
mod limiting_joints;
mod mesh;
mod peaks;
mod rest_ramp;
mod rests;
mod riccati;
mod riccati_parts;
mod row_limit;
mod settings;
mod slack_pair;
mod solution;
mod solver;
mod stage_chain;
mod velocity_rows;

pub use attempt::Window;
pub use cell::Cell;
pub use geometry::Geometry;
pub use limited_segment::{LimitedSegment, SweptNode};
pub use mesh::Mesh;
pub use rest_ramp::{RestRamp, fade};
pub use row_limit::{PathRow, RowLimit, RowLimits};
pub use solution::Solution;
pub use solver::SolveError;
