//! Scenes around a robot at another place in its cell.

use iiwa_json::{are_known, excerpt, meant};
use iiwa_kin::Pose;

use crate::{
    rotation::unit,
    scene::{Form, Obstacle, Scene},
};

/// Error of an obstacle name that a scene does not have.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown obstacle `{}`; {}", excerpt(.name), .alternatives)]
pub struct UnknownObstacle {
    name: String,
    /// Names of the scene, as part of a sentence.
    alternatives: String,
}

impl UnknownObstacle {
    fn new(name: &str, obstacles: &[Obstacle]) -> Self {
        /// Longest list of names: a longer one hides the message.
        const MAX_LISTED: usize = 20;

        let known: Vec<&str> = obstacles.iter().map(|it| it.name.as_str()).collect();
        let alternatives = if known.len() <= MAX_LISTED {
            are_known(&known)
        } else if let Some(word) = meant(name, known.iter().copied()) {
            format!("did you mean `{word}`?")
        } else {
            format!("the scene has {} others", known.len())
        };
        Self { name: name.to_owned(), alternatives }
    }

    /// Returns the name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }
}

impl Scene {
    /// Returns the indices of the obstacles with these names, in the order of the names.
    ///
    /// # Errors
    ///
    /// The first name that the scene does not have.
    pub fn indices_of(&self, names: &[impl AsRef<str>]) -> Result<Vec<usize>, UnknownObstacle> {
        let index = |name: &str| {
            let index = self.obstacles.iter().position(|obstacle| obstacle.name == name);
            index.ok_or_else(|| UnknownObstacle::new(name, &self.obstacles))
        };
        names.iter().map(|name| index(name.as_ref())).collect()
    }

    /// Returns the scene around the robot at another place in its cell. `cell` is the pose of the
    /// former robot base in the new one, as for [`Program::with_cell_at`].
    ///
    /// Obstacles keep their places in the cell, except those with the indices `with_robot`: they
    /// move with the robot base, and their poses in its frame do not change. The tool moves with
    /// the robot in any case. Ignored pairs stay ignored.
    ///
    /// ```
    /// use iiwa_kin::Pose;
    /// use iiwa_scene::{Form, Scene};
    ///
    /// let scene = Scene::from_json(r#"{ "version": 1, "obstacles": [
    ///     { "name": "pedestal", "type": "box", "center_mm": [0, 0, -200],
    ///       "size_mm": [400, 400, 400] },
    ///     { "name": "lamp", "type": "sphere", "center_mm": [500, 0, 900], "radius_mm": 80 }
    /// ] }"#)?;
    /// // The robot moves by 100 mm towards the lamp, and so does its pedestal.
    /// let cell = Pose::from_xyz_abc([-0.1, 0.0, 0.0], [0.0; 3]);
    /// let moved = scene.with_cell_at(&cell, &scene.indices_of(&["pedestal"])?);
    /// assert_eq!(moved.obstacles()[0], scene.obstacles()[0]);
    /// let Form::Sphere { center_m, .. } = moved.obstacles()[1].form else { panic!() };
    /// assert!((center_m[0] - 0.4).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// [`Program::with_cell_at`]: iiwa_program::Program::with_cell_at
    #[must_use]
    pub fn with_cell_at(&self, cell: &Pose, with_robot: &[usize]) -> Self {
        let obstacles = self.obstacles.iter().enumerate().map(|(index, obstacle)| {
            if with_robot.contains(&index) {
                return obstacle.clone();
            }
            Obstacle { name: obstacle.name.clone(), form: obstacle.form.moved(cell) }
        });
        Self {
            obstacles: obstacles.collect(),
            tool: self.tool.clone(),
            ignored: self.ignored.clone(),
        }
    }
}

impl Form {
    /// Returns the form in another frame. `cell` is the pose of the former frame in it.
    fn moved(&self, cell: &Pose) -> Self {
        let point = |at_m: [f64; 3]| {
            let pose = Pose { position_m: at_m, ..Pose::IDENTITY };
            cell.then(&pose).position_m
        };
        // Roll, pitch and yaw are KUKA's angles C, B and A.
        let pose = |at_m: [f64; 3], [roll, pitch, yaw]: [f64; 3]| {
            let pose = cell.then(&Pose::from_xyz_abc(at_m, [yaw, pitch, roll]));
            let [yaw, pitch, roll] = pose.abc_rad();
            (pose.position_m, [roll, pitch, yaw])
        };
        match *self {
            Self::Box { center_m, size_m, rpy_rad } => {
                let (center_m, rpy_rad) = pose(center_m, rpy_rad);
                Self::Box { center_m, size_m, rpy_rad }
            }
            Self::Plane { point_m, normal } => {
                let normal = unit(normal);
                let normal = cell.rotation.map(|row| normal.dot(row.into()));
                Self::Plane { point_m: point(point_m), normal }
            }
            Self::Cylinder { center_m, radius_m, length_m, rpy_rad } => {
                let (center_m, rpy_rad) = pose(center_m, rpy_rad);
                Self::Cylinder { center_m, radius_m, length_m, rpy_rad }
            }
            Self::Sphere { center_m, radius_m } => {
                Self::Sphere { center_m: point(center_m), radius_m }
            }
            Self::Mesh { ref surface, origin_m, rpy_rad } => {
                let (origin_m, rpy_rad) = pose(origin_m, rpy_rad);
                Self::Mesh { surface: surface.clone(), origin_m, rpy_rad }
            }
        }
    }
}
