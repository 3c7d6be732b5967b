//! Tool of the robot.

use crate::{
    extent::{MAX_ANGLE_RAD, MAX_M, MIN_SIZE_M},
    fault::SceneFault,
    hull::ConvexHull,
};

/// Shape of the tool, in the flange frame: z out of the flange.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_scene::{ArmInScene, Form, Obstacle, Scene, ToolShape};
///
/// let floor = Form::Plane { point_m: [0.0; 3], normal: [0.0, 0.0, 1.0] };
/// let floor = Obstacle { name: "floor".to_owned(), form: floor };
/// let rod = ToolShape::Cylinder {
///     center_m: [0.0, 0.0, 0.1], radius_m: 0.01, length_m: 0.2, rpy_rad: [0.0; 3],
/// };
/// let scene = Scene::new(vec![floor])?.with_tool(vec![rod])?;
/// let robot = Robot::lbr_iiwa_7_r800();
/// let down = [0.0, 0.5, 0.0, -1.5, 0.0, 1.141592653589793, 0.0];
/// let clearance = ArmInScene::new(&robot, &scene).clearance(&down).expect("there is a floor");
/// // The rod is 0.2 m long and points down.
/// let height_m = robot.flange_position(&down)[2];
/// assert!((clearance.distance_m - (height_m - 0.2)).abs() < 1e-9);
/// assert_eq!(clearance.link, 8);
/// # Ok::<(), iiwa_scene::SceneFault>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ToolShape {
    /// Solid box.
    Box {
        /// Centre, in m.
        center_m: [f64; 3],
        /// Full lengths along the box axes, in m.
        size_m: [f64; 3],
        /// Rotation about x, then y, then z, the axes of the flange, in rad.
        rpy_rad: [f64; 3],
    },
    /// Cylinder with flat ends, along its z axis.
    Cylinder {
        /// Centre, in m.
        center_m: [f64; 3],
        /// Radius, in m.
        radius_m: f64,
        /// Full length, in m.
        length_m: f64,
        /// Rotation about x, then y, then z, the axes of the flange, in rad.
        rpy_rad: [f64; 3],
    },
    /// Sphere.
    Sphere {
        /// Centre, in m.
        center_m: [f64; 3],
        /// Radius, in m.
        radius_m: f64,
    },
    /// Convex hull of a mesh.
    Mesh {
        /// Hull, in the mesh frame.
        hull: ConvexHull,
        /// Position of the mesh origin, in m.
        origin_m: [f64; 3],
        /// Rotation about x, then y, then z, the axes of the flange, in rad.
        rpy_rad: [f64; 3],
    },
}

impl ToolShape {
    /// Checks the shape at index `shape`; the error is the first fault.
    pub(crate) fn check(&self, shape: usize) -> Result<(), SceneFault> {
        let within = |key, values: &[f64], [min, max]: [f64; 2]| {
            let wrong = values.iter().position(|value| !(min..=max).contains(value));
            wrong.map_or(Ok(()), |axis| {
                let axis_of = (values.len() > 1).then_some(axis);
                Err(SceneFault::Tool { shape, key, axis: axis_of, found: values[axis], min, max })
            })
        };
        let turns = [-MAX_ANGLE_RAD, MAX_ANGLE_RAD];
        let place = |center: &[f64; 3], turn: &[f64; 3]| {
            within("center", center, [-MAX_M, MAX_M])?;
            within("rpy", turn, turns)
        };
        let size = [MIN_SIZE_M, MAX_M];
        match self {
            ToolShape::Box { center_m, size_m, rpy_rad } => {
                place(center_m, rpy_rad)?;
                within("size", size_m, size)
            }
            ToolShape::Cylinder { center_m, radius_m, length_m, rpy_rad } => {
                place(center_m, rpy_rad)?;
                within("radius", &[*radius_m], size)?;
                within("length", &[*length_m], size)
            }
            ToolShape::Sphere { center_m, radius_m } => {
                place(center_m, &[0.0; 3])?;
                within("radius", &[*radius_m], size)
            }
            ToolShape::Mesh { origin_m, rpy_rad, .. } => {
                within("origin", origin_m, [-MAX_M, MAX_M])?;
                within("rpy", rpy_rad, turns)
            }
        }
    }
}
