//! Form of a scene for drawings: m, unit vectors, matrices.

use serde::{Serialize, Serializer};

use crate::{
    carried::CarriedBodies,
    rotation::{rotation, unit},
    scene::{Form, Obstacle, Scene},
    tool::ToolShape,
};

#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum DrawnObstacle<'a> {
    Box {
        #[serde(skip_serializing_if = "Option::is_none")]
        name: Option<&'a str>,
        center_m: [f64; 3],
        size_m: [f64; 3],
        /// Three rows; the columns are the box axes.
        rotation: [[f64; 3]; 3],
    },
    Plane {
        name: &'a str,
        point_m: [f64; 3],
        /// Unit vector.
        normal: [f64; 3],
    },
    /// Cylinder along its z axis.
    Cylinder {
        #[serde(skip_serializing_if = "Option::is_none")]
        name: Option<&'a str>,
        center_m: [f64; 3],
        radius_m: f64,
        length_m: f64,
        rotation: [[f64; 3]; 3],
    },
    Sphere {
        #[serde(skip_serializing_if = "Option::is_none")]
        name: Option<&'a str>,
        center_m: [f64; 3],
        radius_m: f64,
    },
    /// Hull with corners in its own frame.
    Hull {
        origin_m: [f64; 3],
        rotation: [[f64; 3]; 3],
        corners_m: Vec<[f64; 3]>,
        triangles: &'a [[u32; 3]],
    },
    /// Surface with corners in its own frame.
    Mesh {
        name: &'a str,
        origin_m: [f64; 3],
        rotation: [[f64; 3]; 3],
        corners_m: Vec<[f64; 3]>,
        triangles: &'a [[u32; 3]],
    },
}

impl<'a> From<&'a Obstacle> for DrawnObstacle<'a> {
    fn from(Obstacle { name, form }: &'a Obstacle) -> Self {
        match *form {
            Form::Box { center_m, size_m, rpy_rad } => {
                Self::Box { name: Some(name), center_m, size_m, rotation: rows(rpy_rad) }
            }
            Form::Plane { point_m, normal } => {
                Self::Plane { name, point_m, normal: unit(normal).into() }
            }
            Form::Cylinder { center_m, radius_m, length_m, rpy_rad } => {
                let (name, rotation) = (Some(name.as_str()), rows(rpy_rad));
                Self::Cylinder { name, center_m, radius_m, length_m, rotation }
            }
            Form::Sphere { center_m, radius_m } => {
                Self::Sphere { name: Some(name), center_m, radius_m }
            }
            Form::Mesh { ref surface, origin_m, rpy_rad } => Self::Mesh {
                name,
                origin_m,
                rotation: rows(rpy_rad),
                corners_m: rounded(surface.points_m()),
                triangles: surface.triangles(),
            },
        }
    }
}

impl<'a> From<&'a ToolShape> for DrawnObstacle<'a> {
    fn from(shape: &'a ToolShape) -> Self {
        match *shape {
            ToolShape::Box { center_m, size_m, rpy_rad } => {
                Self::Box { name: None, center_m, size_m, rotation: rows(rpy_rad) }
            }
            ToolShape::Cylinder { center_m, radius_m, length_m, rpy_rad } => {
                let rotation = rows(rpy_rad);
                Self::Cylinder { name: None, center_m, radius_m, length_m, rotation }
            }
            ToolShape::Sphere { center_m, radius_m } => {
                Self::Sphere { name: None, center_m, radius_m }
            }
            ToolShape::Mesh { ref hull, origin_m, rpy_rad } => Self::Hull {
                origin_m,
                rotation: rows(rpy_rad),
                corners_m: rounded(hull.corners_m()),
                triangles: hull.triangles(),
            },
        }
    }
}

/// Returns the rotation, without negative zeros.
fn rows(rpy_rad: [f64; 3]) -> [[f64; 3]; 3] {
    rotation(rpy_rad).map(|row| row.map(|v| v + 0.0))
}

/// Rounds corners to the micrometre: finer than any screen, and short as text.
fn rounded(corners_m: &[[f64; 3]]) -> Vec<[f64; 3]> {
    corners_m.iter().map(|corner| corner.map(|v| (v * 1e6).round() / 1e6 + 0.0)).collect()
}

/// Serialises the bodies with their shapes in the flange frame, as the tool of a scene.
impl Serialize for CarriedBodies {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct BodyView<'a> {
            part: usize,
            shapes: Vec<DrawnObstacle<'a>>,
        }
        #[derive(Serialize)]
        struct CarriedView<'a> {
            bodies: Vec<BodyView<'a>>,
        }
        let bodies = self.bodies().iter().map(|body| BodyView {
            part: body.part,
            shapes: body.shapes.iter().map(DrawnObstacle::from).collect(),
        });
        CarriedView { bodies: bodies.collect() }.serialize(serializer)
    }
}

/// Serialises the obstacles in the base frame and the tool shapes in the flange frame, with
/// positions in m: a box as `center_m`, `size_m` and `rotation` (three rows; the columns are its
/// axes), a plane as `point_m` and `normal` (a unit vector), a cylinder as `center_m`, `radius_m`,
/// `length_m` and `rotation`, a sphere as `center_m` and `radius_m`, a hull or a mesh as
/// `origin_m`, `rotation`, and `corners_m` with the indices in `triangles`.
impl Serialize for Scene {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct SceneView<'a> {
            obstacles: Vec<DrawnObstacle<'a>>,
            tool: Vec<DrawnObstacle<'a>>,
        }
        let obstacles = self.obstacles().iter().map(DrawnObstacle::from).collect();
        SceneView { obstacles, tool: self.tool().iter().map(DrawnObstacle::from).collect() }
            .serialize(serializer)
    }
}
