//! Geometric path of a KUKA LBR iiwa motion program: lines in joint space, TCP lines, circles and
//! splines, and blends that round off their corners. The crate does not compute the times of
//! motions: a path contains their limits, and the durations of waits.
//!
//! ```
//! use iiwa_kin::Robot;
//! use iiwa_path::JointPath;
//! use iiwa_program::Program;
//!
//! let program = Program::from_json(r#"{
//!     "version": 1,
//!     "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
//!     "motions": [
//!         { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0], "blend": { "cart_mm": 50 } },
//!         { "type": "ptp", "joints_deg": [40, 30, 0, -60, 0, 90, 0] }
//!     ]
//! }"#)?;
//! let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800())?;
//! let (corner, blend) = path.blends().next().expect("one corner is blended away");
//! println!("corner angle {:.1} deg, middle of the blend {:?}", corner.gamma_deg, blend.at(0.5).q);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`JointPath`] is a list of [`Step`]s. A step in which the robot moves contains a [`Segment`],
//! which gives the joint positions and their first three derivatives with respect to s at any s in
//! [0, 1]. `Segment` is a trait: a path from [`JointPath::from_steps`] can contain your own segment
//! types.
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapters 2.3 and 4, cited as "Larsen 2019".

#![expect(
    clippy::inline_always,
    reason = "kernels must be inlined into the function that enables vector instructions"
)]

mod along_inverse;
mod builder;
mod carried;
mod cartesian;
mod circle;
mod continuity;
mod crossing;
mod join;
mod joint_spline;
mod legs;
mod line;
mod options;
mod path;
mod planar_graph;
mod polynomial;
mod segment;
mod step;
mod supervised;
mod tool_coordinate;
mod turn_contradiction;

pub use circle::CircularBlend;
pub use continuity::{BlendBasis, Continuity};
pub use crossing::BlendSearch;
pub use join::JoinError;
pub use line::Line;
pub use options::{BlendShape, PathOptions};
pub use path::{JointPath, ReplacedSteps};
pub use planar_graph::{BlendPolynomials, PLACES, PlanarGraph};
pub use polynomial::{KAPPA_MIN_ACCELERATION, PolynomialBlend};
pub use segment::{Derivatives, Segment, ToolWay};
pub use step::{Corner, ShortenedBlend, SplineStop, Step};
pub use tool_coordinate::{Coordinates, ToolCoordinate};
pub use turn_contradiction::TurnContradiction;
