//! Smallest distance between a KUKA LBR iiwa and the obstacles of a scene, at a pose and over a
//! whole planned motion.
//!
//! ```
//! use iiwa_kin::Robot;
//! use iiwa_path::JointPath;
//! use iiwa_program::Program;
//! use iiwa_scene::{ArmInScene, Scene};
//! use iiwa_traj::{Timing, Trajectory};
//!
//! let scene = Scene::from_json(r#"{
//!     "version": 1,
//!     "obstacles": [
//!         { "name": "table", "type": "box", "center_mm": [0, 0, -25],
//!           "size_mm": [1200, 800, 50] },
//!         { "name": "wall", "type": "plane", "point_mm": [-600, 0, 0], "normal": [1, 0, 0] }
//!     ]
//! }"#)?;
//! let robot = Robot::lbr_iiwa_7_r800();
//! let arm = ArmInScene::new(&robot, &scene);
//!
//! // With the arm stretched out upwards, the nearest part whose distance varies is the upper arm,
//! // which begins 340 mm above the table.
//! let clearance = arm.clearance(&[0.0; 7]).expect("there are obstacles");
//! assert!((clearance.distance_m - 0.34).abs() < 1e-6);
//! assert_eq!(arm.name_of(clearance.other), "table");
//!
//! # let text = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
//! #     "motions": [{ "type": "ptp", "joints_deg": [0, 60, 0, -80, 0, 40, 0] }] }"#;
//! let path = JointPath::new(&Program::from_json(text)?, &robot)?;
//! let trajectory = Trajectory::plan(&path, Timing::default())?;
//! let smallest = arm.clearance_of(&trajectory).expect("there are obstacles");
//! println!("{:.1} mm at {:.3} s", 1e3 * smallest.clearance.distance_m, smallest.at_s);
//!
//! // The links keep clear of each other as well.
//! let own = arm.self_clearance_of(&trajectory).expect("the arm has links");
//! assert!(own.clearance.distance_m > 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The arm consists of the cylinders and spheres of its URDF, [`iiwa_kin::Robot::link_shapes`], and
//! obstacles are boxes, cylinders, spheres, half-spaces, and the [surfaces](TriangleSurface) of
//! meshes. A tool consists of boxes, cylinders, spheres, and [convex hulls](ConvexHull) of meshes.
//! Shapes that touch or overlap have a distance of 0. Distances of
//! poses are exact to 0.1 um; over a motion, every pose is covered, and the smallest distance is
//! found to 0.1 mm.
//!
//! With [`ArmMeshes`], the arm consists of the convex hulls of the meshes of a user's URDF instead.
//!
//! Units are SI and radians; positions are in the base frame, `iiwa_link_0`.

mod allowed_clearances;
mod arm;
mod arm_meshes;
mod carried;
mod clearance;
mod collada;
mod distance;
mod extent;
mod fault;
mod gjk;
mod hull;
mod links;
mod mesh;
mod mesh_error;
mod mesh_file;
mod moved;
mod patch;
mod placed;
mod placed_box;
mod placed_mesh;
mod planned;
mod polyhedron;
mod quickhull;
mod rotation;
mod scene;
mod span;
mod stl;
mod surface;
mod tool;
mod wire;

pub use allowed_clearances::AllowedClearances;
pub use arm_meshes::{ArmMeshError, ArmMeshes};
pub use carried::{CarriedBodies, CarriedBody, CarriedMeshError};
pub use clearance::{ArmInScene, Clearance, Other};
pub use collada::ColladaError;
pub use fault::SceneFault;
pub use hull::{ConvexHull, NotSolid};
pub use links::IgnoredPair;
pub use mesh::TriangleMesh;
pub use mesh_error::TriangleMeshError;
pub use mesh_file::{ExtentFault, MeshError};
pub use moved::UnknownObstacle;
pub use patch::Patch;
pub use planned::PlannedClearance;
pub use scene::{Form, Obstacle, Scene};
pub use surface::{SurfaceError, TriangleSurface};
pub use tool::ToolShape;
pub use wire::SceneError;
