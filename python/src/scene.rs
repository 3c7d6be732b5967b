//! Scenes and clearances.

use std::{collections::BTreeMap, path::PathBuf, sync::Arc};

use iiwa_files::{beside, read_mesh};
use iiwa_scene::{ArmInScene, Clearance as Distance, PlannedClearance, Scene as Obstacles};
use pyo3::{
    exceptions::PyValueError,
    prelude::*,
    types::{PyBytes, PyDict},
};

use crate::{
    Pickled,
    arrays::{JointsLike, Rows},
    errors::{read_text, scene_error},
    options::RobotArgument,
};

/// The obstacles around the arm, and its tool. Immutable; read from a file or from JSON.
///
/// >>> import iiwasim as iw
/// >>> iw.Scene.load('fixtures/cage.json')
/// <iiwasim.Scene 10 obstacles>
#[pyclass(frozen, module = "iiwasim")]
pub(crate) struct Scene {
    pub(crate) parsed: Arc<Obstacles>,
    /// The scene text, as read.
    text: Arc<str>,
    /// The mesh files, by their names in the scene.
    meshes: BTreeMap<String, Vec<u8>>,
}

impl Scene {
    /// An empty scene.
    pub(crate) fn bare() -> PyResult<Self> {
        let scene =
            Obstacles::new(Vec::new()).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let text = r#"{"version": 1, "obstacles": []}"#.into();
        Ok(Self { parsed: Arc::new(scene), text, meshes: BTreeMap::new() })
    }
}

#[pymethods]
impl Scene {
    /// Reads a scene from its text. Raises `SceneError` with line and column.
    ///
    /// >>> import iiwasim as iw
    /// >>> wall = {'name': 'wall', 'type': 'plane', 'point_mm': [700, 0, 0], 'normal': [-1, 0, 0]}
    /// >>> import json
    /// >>> iw.Scene.from_json(json.dumps({'version': 1, 'obstacles': [wall]})).obstacles
    /// ['wall']
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        let scene = Obstacles::from_json(text).map_err(|error| scene_error(py, &error))?;
        Ok(Self { parsed: Arc::new(scene), text: text.into(), meshes: BTreeMap::new() })
    }

    /// Reads a scene from a file, with the mesh files that it names.
    ///
    /// >>> import iiwasim as iw
    /// >>> len(iw.Scene.load('fixtures/cage.json').obstacles)
    /// 10
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let text = read_text(py, &path, "SceneError")?;
        let mut meshes = BTreeMap::new();
        let mesh = |name: &str| {
            let file = beside(&path, name, &["stl", "obj"]).map_err(|error| error.to_string())?;
            let bytes = read_mesh(&file)?;
            meshes.insert(name.to_owned(), bytes.clone());
            Ok(bytes)
        };
        let scene =
            Obstacles::from_json_with(&text, mesh).map_err(|error| scene_error(py, &error))?;
        Ok(Self { parsed: Arc::new(scene), text: text.into(), meshes })
    }

    /// The names of the obstacles.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Scene.load('fixtures/cage.json').obstacles[0]
    /// 'floor'
    #[getter]
    fn obstacles(&self) -> Vec<String> {
        self.parsed.obstacles().iter().map(|it| it.name.clone()).collect()
    }

    /// Clearance between robot and obstacles at `q` (7,), in rad; `None` without obstacles.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Scene.load('fixtures/cage.json').clearance([0.0] * 7).distance_m > 0
    /// True
    #[pyo3(signature = (q, *, robot = None))]
    fn clearance<'py>(
        &self,
        py: Python<'py>,
        q: JointsLike<'py>,
        robot: Option<RobotArgument<'py>>,
    ) -> PyResult<Option<Clearance>> {
        let robot = robot.map(|robot| robot.model(py)).transpose()?.unwrap_or_default();
        let rows = Rows::new("q", &q)?;
        let arm = ArmInScene::new(&robot, &self.parsed);
        let distance = arm.clearance(rows.single("q")?);
        Ok(distance.map(|distance| Clearance::new(&arm, &distance, None)))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py>> {
        let (py, scene) = (slf.py(), slf.get());
        let meshes = PyDict::new(py);
        for (name, bytes) in &scene.meshes {
            meshes.set_item(name, PyBytes::new(py, bytes))?;
        }
        Ok((slf.get_type().getattr("_restore")?, (&*scene.text, meshes).into_pyobject(py)?))
    }

    #[staticmethod]
    #[pyo3(signature = (text, meshes, /))]
    fn _restore(py: Python<'_>, text: &str, meshes: BTreeMap<String, Vec<u8>>) -> PyResult<Self> {
        let mesh = |name: &str| meshes.get(name).cloned().ok_or_else(|| "it is missing".to_owned());
        let scene =
            Obstacles::from_json_with(text, mesh).map_err(|error| scene_error(py, &error))?;
        Ok(Self { parsed: Arc::new(scene), text: text.into(), meshes })
    }

    fn __repr__(&self) -> String {
        let count = self.parsed.obstacles().len();
        format!("<iiwasim.Scene {count} obstacle{}>", if count == 1 { "" } else { "s" })
    }
}

/// The minimum distance between the robot and an obstacle or another link, with its place and time.
/// `link` is 2 to 7, 8 for the tool or 9 for the workpiece.
///
/// >>> import iiwasim as iw
/// >>> near = iw.Scene.load('fixtures/cage.json').clearance([0.0] * 7)
/// >>> near.link in range(2, 9), near.at_s
/// (True, None)
#[pyclass(frozen, get_all, module = "iiwasim")]
pub(crate) struct Clearance {
    distance_m: f64,
    link: usize,
    obstacle: String,
    at_s: Option<f64>,
    motion: Option<usize>,
    on_link_m: [f64; 3],
    on_obstacle_m: [f64; 3],
}

impl Clearance {
    pub(crate) fn new(
        arm: &ArmInScene,
        distance: &Distance,
        when: Option<&PlannedClearance>,
    ) -> Self {
        Self {
            distance_m: distance.distance_m,
            link: distance.link,
            obstacle: arm.name_of(distance.other),
            at_s: when.map(|when| when.at_s),
            motion: when.map(|when| when.motion.number()),
            on_link_m: distance.on_link_m,
            on_obstacle_m: distance.on_other_m,
        }
    }
}

#[pymethods]
impl Clearance {
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py>> {
        let (py, clearance) = (slf.py(), slf.get());
        let parts = (
            clearance.distance_m,
            clearance.link,
            clearance.obstacle.as_str(),
            clearance.at_s,
            clearance.motion,
            clearance.on_link_m,
            clearance.on_obstacle_m,
        );
        Ok((slf.get_type().getattr("_restore")?, parts.into_pyobject(py)?))
    }

    #[staticmethod]
    #[pyo3(signature = (distance_m, link, obstacle, at_s, motion, on_link_m, on_obstacle_m, /))]
    fn _restore(
        distance_m: f64,
        link: usize,
        obstacle: String,
        at_s: Option<f64>,
        motion: Option<usize>,
        on_link_m: [f64; 3],
        on_obstacle_m: [f64; 3],
    ) -> Self {
        Self { distance_m, link, obstacle, at_s, motion, on_link_m, on_obstacle_m }
    }

    fn __repr__(&self) -> String {
        let time = self.at_s.map_or_else(String::new, |at_s| format!(" at {at_s:.3} s"));
        format!(
            "<iiwasim.Clearance {:.1} mm, link {} to {}{time}>",
            1e3 * self.distance_m,
            self.link,
            self.obstacle
        )
    }
}
