//! Motion programs of the KUKA LBR iiwa, and the geometric path that the arm takes through them:
//! lines in joint space, and blends that round off their corners. It knows nothing of time.
//!
//! ```
//! use iiwa_kin::Robot;
//! use iiwa_path::{JointPath, Program};
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
//! A [`JointPath`] is a list of [`Step`]s. Those that move hold a [`Segment`], which gives the joint
//! positions and their first three derivatives at any s in [0, 1]: a trait, so that a new shape is one
//! new type.
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapters 2.3 and 4, cited as "Larsen 2019".

#![expect(
    clippy::inline_always,
    reason = "kernels belong into the function that enables vector instructions"
)]

mod along_inverse;
mod blend;
mod builder;
mod cartesian;
mod cartesian_motion;
mod circle;
mod continuity;
mod coordinates;
mod crossing;
mod fault;
mod frame;
mod grid;
mod join;
mod joint_spline;
mod limit_kind;
mod line;
mod motion_index;
mod motion_limits;
mod options;
mod path;
mod path_motion;
mod placed_frame;
mod planar_graph;
pub mod playback;
mod polynomial;
mod program;
mod program_builder;
mod segment;
mod sigma;
mod step;
mod supervised;
mod target;
mod tool_coordinate;
mod tool_limits;
mod tool_way;
mod turn_contradiction;
mod wire;
mod workcell;

pub use blend::Blend;
pub use cartesian::{CartesianFault, CourseFault};
pub use cartesian_motion::{
    AuxOrientation, CartesianMotion, Circ, Course, MAX_SEGMENTS, OrientationType, PathBlend,
    SegmentCourse, SplineSegment,
};
pub use circle::CircularBlend;
pub use continuity::Continuity;
pub use coordinates::Coordinates;
pub use crossing::BlendSearch;
pub use fault::Fault;
pub use frame::Frame;
pub use grid::{Grid, GridNode};
pub use join::JoinError;
pub use limit_kind::{ByKind, LimitKind};
pub use line::Line;
pub use motion_index::MotionIndex;
pub use motion_limits::MotionLimits;
pub use options::{BlendShape, PathOptions};
pub use path::{JointPath, ReplacedSteps};
pub use path_motion::MotionType;
pub use placed_frame::PlacedFrame;
pub use planar_graph::{PLACES, PlanarGraph};
pub use polynomial::{KAPPA_MIN_ACCELERATION, PolynomialBlend};
pub use program::{Motion, Program, Ptp, Start};
pub use program_builder::ProgramBuilder;
pub use segment::{Derivatives, Segment};
pub use step::{Corner, Step};
pub use target::{Target, TargetRef};
pub use tool_coordinate::ToolCoordinate;
pub use tool_limits::ToolLimits;
pub use tool_way::ToolWay;
pub use turn_contradiction::TurnContradiction;
pub use wire::ProgramError;
pub use workcell::{Base, Load, NameFault, OperatingMode, T1_SPEED_M_S, Tool, Workcell};
