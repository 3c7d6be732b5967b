//! The obstacles around the arm.

use std::collections::HashMap;

use crate::{
    extent::{MAX_ANGLE_RAD, MAX_M, MIN_SIZE_M},
    fault::Fault,
    links::{FIRST_LINK, IgnoredPair, TOOL},
    tool::ToolShape,
};

/// The obstacles around an arm, in the frame of its base: z up, origin in the middle of its foot; and the tool that it
/// carries.
///
/// [`Scene::from_json`] reads one. It serializes as a drawing needs it: in m, with directions as unit
/// vectors and turns as matrices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    obstacles: Vec<Obstacle>,
    tool: Vec<ToolShape>,
    ignored: Vec<IgnoredPair>,
}

/// Something that the arm must not touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// What it is called: 1 to 100 characters, and no other obstacle of the scene by the same name.
    pub name: String,
    /// What it looks like, and where it is.
    pub form: Form,
}

/// What an obstacle looks like, and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Form {
    /// A solid box.
    Box {
        /// Its centre, in m.
        center_m: [f64; 3],
        /// Its whole lengths along its own axes, in m.
        size_m: [f64; 3],
        /// How it is turned, as in a URDF: about x, then y, then z, the axes of the base, in rad.
        rpy_rad: [f64; 3],
    },
    /// A half-space: all that is behind a plane is solid.
    Plane {
        /// A point of the plane, in m.
        point_m: [f64; 3],
        /// Which way is out; of any length but zero.
        normal: [f64; 3],
    },
}

/// Most obstacles of a scene.
const MAX_OBSTACLES: usize = 10_000;

/// Most shapes of a tool: each of them costs as much as a link.
pub(crate) const MAX_TOOL_SHAPES: usize = 100;

/// Longest name of an obstacle, in characters.
const MAX_NAME: usize = 100;

impl Scene {
    /// The scene with these obstacles.
    ///
    /// # Errors
    ///
    /// A [`Fault`] that says which of them cannot be, and why.
    pub fn new(obstacles: Vec<Obstacle>) -> Result<Self, Fault> {
        if obstacles.len() > MAX_OBSTACLES {
            return Err(Fault::TooMany { found: obstacles.len(), max: MAX_OBSTACLES });
        }
        let mut names = HashMap::with_capacity(obstacles.len());
        for (index, obstacle) in obstacles.iter().enumerate() {
            obstacle.check(index)?;
            if let Some(other) = names.insert(obstacle.name.as_str(), index) {
                let name = obstacle.name.clone();
                return Err(Fault::SameName { obstacle: index, other, name });
            }
        }
        Ok(Self { obstacles, ..Self::default() })
    }

    /// The same, with an arm that carries a tool of these shapes.
    ///
    /// # Errors
    ///
    /// A [`Fault`] that says which of them cannot be, and why.
    pub fn with_tool(self, tool: Vec<ToolShape>) -> Result<Self, Fault> {
        if tool.len() > MAX_TOOL_SHAPES {
            return Err(Fault::LargeTool { found: tool.len(), max: MAX_TOOL_SHAPES });
        }
        tool.iter().enumerate().try_for_each(|(index, shape)| shape.check(index))?;
        Ok(Self { tool, ..self })
    }

    /// The same, without the distances of these pairs: of what touches by design, as a base that the arm is mounted on.
    ///
    /// # Errors
    ///
    /// [`Fault::Ignored`] if there is no such link or no such obstacle.
    pub fn with_ignored(self, ignored: Vec<IgnoredPair>) -> Result<Self, Fault> {
        let exists = |it: &IgnoredPair| {
            (FIRST_LINK..=TOOL).contains(&it.link) && it.obstacle < self.obstacles.len()
        };
        match ignored.iter().position(|it| !exists(it)) {
            Some(pair) => Err(Fault::Ignored { pair, found: ignored[pair] }),
            None => Ok(Self { ignored, ..self }),
        }
    }

    /// The pairs whose distances do not count.
    #[must_use]
    pub fn ignored(&self) -> &[IgnoredPair] {
        &self.ignored
    }

    /// The shapes of the tool; none if the flange is bare.
    #[must_use]
    pub fn tool(&self) -> &[ToolShape] {
        &self.tool
    }

    /// The obstacles, in the order in which they were given.
    #[must_use]
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }
}

impl Obstacle {
    /// Finds the first thing about the obstacle at `obstacle` that cannot be.
    fn check(&self, obstacle: usize) -> Result<(), Fault> {
        let length = self.name.chars().count();
        if length == 0 || length > MAX_NAME || self.name.contains(char::is_control) {
            let found = self.name.chars().take(MAX_NAME).collect();
            return Err(Fault::Name { obstacle, found, max: MAX_NAME });
        }
        let within = |key, values: &[f64; 3], min: f64, max: f64| match values
            .iter()
            .position(|value| !(min..=max).contains(value))
        {
            None => Ok(()),
            Some(axis) => Err(Fault::Range { obstacle, key, axis, found: values[axis], min, max }),
        };
        match &self.form {
            Form::Box { center_m, size_m, rpy_rad } => {
                within("center", center_m, -MAX_M, MAX_M)?;
                within("size", size_m, MIN_SIZE_M, MAX_M)?;
                within("rpy", rpy_rad, -MAX_ANGLE_RAD, MAX_ANGLE_RAD)
            }
            Form::Plane { point_m, normal } => {
                within("point", point_m, -MAX_M, MAX_M)?;
                within("normal", normal, f64::MIN, f64::MAX)?;
                if normal.iter().all(|value| *value == 0.0) {
                    return Err(Fault::NoDirection { obstacle });
                }
                Ok(())
            }
        }
    }
}
