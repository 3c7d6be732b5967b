//! The smallest distance between a KUKA LBR iiwa and the obstacles of a scene, at a pose and over a
//! whole planned motion.

mod arm;
mod clearance;
mod distance;
mod fault;
mod placed;
mod planned;
mod scene;
mod span;
mod wire;

pub use clearance::{ArmInScene, Clearance};
pub use fault::Fault;
pub use planned::PlannedClearance;
pub use scene::{Form, Obstacle, Scene};
pub use wire::SceneError;
