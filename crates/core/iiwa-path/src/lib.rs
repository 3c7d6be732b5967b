//! Geometric path of a KUKA LBR iiwa motion program: lines in joint space, TCP lines, circles and
//! splines, and blends that round off their corners. The crate has no notion of time.
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
//! println!("a turn by {:.1} deg, by way of {:?}", corner.gamma_deg, blend.at(0.5).q);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`JointPath`] is a list of [`Step`]s. A step with motion holds a [`Segment`], which gives the
//! joint positions and their first three derivatives at any s in [0, 1]. `Segment` is a trait: a
//! path from [`JointPath::from_steps`] can contain segments of other types.
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapters 2.3 and 4, cited as "Larsen 2019".

#![expect(
    clippy::inline_always,
    reason = "kernels belong into the function that enables vector instructions"
)]

mod along_inverse;
mod builder;
mod carried;
mod cartesian;
mod circle;
mod continuity;
mod coordinates;
mod crossing;
mod join;
mod joint_spline;
mod line;
mod options;
mod path;
mod path_motion;
mod planar_graph;
mod polynomial;
mod segment;
mod sigma;
mod step;
mod supervised;
mod tool_coordinate;
mod tool_way;
mod turn_contradiction;

pub use circle::CircularBlend;
pub use continuity::{BlendBasis, Continuity};
pub use coordinates::Coordinates;
pub use crossing::BlendSearch;
pub use join::JoinError;
pub use line::Line;
pub use options::{BlendShape, PathOptions};
pub use path::{JointPath, ReplacedSteps};
pub use planar_graph::{BlendPolynomials, PLACES, PlanarGraph};
pub use polynomial::{KAPPA_MIN_ACCELERATION, PolynomialBlend};
pub use segment::{Derivatives, Segment};
pub use step::{Corner, Step};
pub use tool_coordinate::ToolCoordinate;
pub use tool_way::ToolWay;
pub use turn_contradiction::TurnContradiction;
