//! Obstacles around the robot.

use std::collections::HashMap;

use crate::{
    extent::{MAX_ANGLE_RAD, MAX_M, MIN_SIZE_M},
    fault::SceneFault,
    links::{FIRST_LINK, IgnoredPair, WORKPIECE},
    surface::{MAX_SURFACE_TRIANGLES, TriangleSurface},
    tool::ToolShape,
};

/// Obstacles around a robot, in its base frame (z up, origin in the centre of the mounting face),
/// and the tool that it carries.
///
/// [`Scene::from_json`] reads a scene. A scene is serialised in the form that drawings need: in m,
/// with directions as unit vectors and rotations as matrices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    pub(crate) obstacles: Vec<Obstacle>,
    pub(crate) tool: Vec<ToolShape>,
    pub(crate) ignored: Vec<IgnoredPair>,
}

/// Obstacle that the robot must not touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Name of 1 to 100 characters, unique in the scene.
    pub name: String,
    /// Shape and pose.
    pub form: Form,
}

/// Shape and pose of an obstacle.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Form {
    /// Solid box.
    Box {
        /// Centre, in m.
        center_m: [f64; 3],
        /// Full lengths along the box axes, in m.
        size_m: [f64; 3],
        /// Rotation as in a URDF: about x, then y, then z, the axes of the base, in rad.
        rpy_rad: [f64; 3],
    },
    /// Half-space: everything behind a plane is solid.
    Plane {
        /// Point of the plane, in m.
        point_m: [f64; 3],
        /// Outward normal, of any non-zero length.
        normal: [f64; 3],
    },
    /// Cylinder with flat ends, along its z axis.
    Cylinder {
        /// Centre, in m.
        center_m: [f64; 3],
        /// Radius, in m.
        radius_m: f64,
        /// Length, in m.
        length_m: f64,
        /// Rotation as in a URDF: about x, then y, then z, the axes of the base, in rad.
        rpy_rad: [f64; 3],
    },
    /// Sphere.
    Sphere {
        /// Centre, in m.
        center_m: [f64; 3],
        /// Radius, in m.
        radius_m: f64,
    },
    /// Surface of a mesh, which has no inside.
    Mesh {
        /// Surface, in the mesh frame.
        surface: TriangleSurface,
        /// Position of the mesh origin, in m.
        origin_m: [f64; 3],
        /// Rotation as in a URDF: about x, then y, then z, the axes of the base, in rad.
        rpy_rad: [f64; 3],
    },
}

/// Maximum number of obstacles of a scene.
const MAX_OBSTACLES: usize = 10_000;

/// Maximum number of shapes of a tool: each costs as much as a link.
pub(crate) const MAX_TOOL_SHAPES: usize = 100;

/// Maximum length of an obstacle name, in characters.
const MAX_NAME: usize = 100;

impl Scene {
    /// Creates a scene with these obstacles.
    ///
    /// # Errors
    ///
    /// A [`SceneFault`] with the invalid obstacle and the reason.
    pub fn new(obstacles: Vec<Obstacle>) -> Result<Self, SceneFault> {
        check_count(obstacles.len())?;
        let mut names = HashMap::with_capacity(obstacles.len());
        for (index, obstacle) in obstacles.iter().enumerate() {
            obstacle.check(index)?;
            if let Some(other) = names.insert(obstacle.name.as_str(), index) {
                let name = obstacle.name.clone();
                return Err(SceneFault::SameName { obstacle: index, other, name });
            }
        }
        check_triangles(obstacles.iter().map(Obstacle::triangles).sum())?;
        Ok(Self { obstacles, ..Self::default() })
    }

    /// Returns the scene with a tool of these shapes.
    ///
    /// # Errors
    ///
    /// A [`SceneFault`] with the invalid shape and the reason.
    pub fn with_tool(self, tool: Vec<ToolShape>) -> Result<Self, SceneFault> {
        if tool.len() > MAX_TOOL_SHAPES {
            return Err(SceneFault::LargeTool { found: tool.len(), max: MAX_TOOL_SHAPES });
        }
        tool.iter().enumerate().try_for_each(|(index, shape)| shape.check(index))?;
        Ok(Self { tool, ..self })
    }

    /// Returns the scene without the distances of these pairs, for parts that touch by design, such
    /// as a base that the robot is mounted on.
    ///
    /// # Errors
    ///
    /// [`SceneFault::Ignored`] if the link or the obstacle does not exist.
    pub fn with_ignored(self, ignored: Vec<IgnoredPair>) -> Result<Self, SceneFault> {
        let exists = |it: &IgnoredPair| {
            (FIRST_LINK..=WORKPIECE).contains(&it.link) && it.obstacle < self.obstacles.len()
        };
        match ignored.iter().position(|it| !exists(it)) {
            Some(pair) => Err(SceneFault::Ignored { pair, found: ignored[pair] }),
            None => Ok(Self { ignored, ..self }),
        }
    }

    /// Returns the pairs whose distances are ignored.
    #[must_use]
    pub fn ignored(&self) -> &[IgnoredPair] {
        &self.ignored
    }

    /// Returns the shapes of the tool; empty for a bare flange.
    #[must_use]
    pub fn tool(&self) -> &[ToolShape] {
        &self.tool
    }

    /// Returns the obstacles, in the order in which they were given.
    #[must_use]
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }
}

/// Checks the number of obstacles of a scene.
pub(crate) fn check_count(found: usize) -> Result<(), SceneFault> {
    let max = MAX_OBSTACLES;
    if found > max { Err(SceneFault::TooMany { found, max }) } else { Ok(()) }
}

/// Checks the number of triangles of all meshes of a scene.
pub(crate) fn check_triangles(found: usize) -> Result<(), SceneFault> {
    let max = MAX_SURFACE_TRIANGLES;
    if found > max { Err(SceneFault::TooManyTriangles { found, max }) } else { Ok(()) }
}

impl Obstacle {
    /// Number of triangles of a mesh; 0 for other shapes.
    pub(crate) fn triangles(&self) -> usize {
        match &self.form {
            Form::Mesh { surface, .. } => surface.triangles().len(),
            _ => 0,
        }
    }

    /// Checks the obstacle at index `obstacle`; the error is the first fault.
    fn check(&self, obstacle: usize) -> Result<(), SceneFault> {
        let length = self.name.chars().count();
        if length == 0 || length > MAX_NAME || self.name.contains(char::is_control) {
            let found = self.name.chars().take(MAX_NAME).collect();
            return Err(SceneFault::Name { obstacle, found, max: MAX_NAME });
        }
        let within = |key, values: &[f64], min: f64, max: f64| {
            let wrong = values.iter().position(|value| !(min..=max).contains(value));
            wrong.map_or(Ok(()), |axis| {
                let axis_of = (values.len() > 1).then_some(axis);
                let found = values[axis];
                Err(SceneFault::Range { obstacle, key, axis: axis_of, found, min, max })
            })
        };
        let position = |key, values: &[f64; 3]| within(key, values, -MAX_M, MAX_M);
        let size = |key, values: &[f64]| within(key, values, MIN_SIZE_M, MAX_M);
        let turn = |rpy_rad: &[f64; 3]| within("rpy", rpy_rad, -MAX_ANGLE_RAD, MAX_ANGLE_RAD);
        match &self.form {
            Form::Box { center_m, size_m, rpy_rad } => {
                position("center", center_m)?;
                size("size", size_m)?;
                turn(rpy_rad)
            }
            Form::Plane { point_m, normal } => {
                position("point", point_m)?;
                within("normal", normal, f64::MIN, f64::MAX)?;
                if normal.iter().all(|value| *value == 0.0) {
                    return Err(SceneFault::NoDirection { obstacle });
                }
                Ok(())
            }
            Form::Cylinder { center_m, radius_m, length_m, rpy_rad } => {
                position("center", center_m)?;
                size("radius", &[*radius_m])?;
                size("length", &[*length_m])?;
                turn(rpy_rad)
            }
            Form::Sphere { center_m, radius_m } => {
                position("center", center_m)?;
                size("radius", &[*radius_m])
            }
            Form::Mesh { origin_m, rpy_rad, .. } => {
                position("origin", origin_m)?;
                turn(rpy_rad)
            }
        }
    }
}
