//! Options of planning and reading, with the names of the command line.

use std::path::PathBuf;

use iiwa_kin::Robot as Model;
use iiwa_log::{AngleUnit, LogOptions, Positions};
use iiwa_path::{BlendSearch, BlendShape, Continuity, PathOptions};
use iiwa_plan::PlanOptions;
use iiwa_traj::{JerkOptions, SweepOptions, Timing};
use pyo3::{exceptions::PyValueError, prelude::*};

use crate::{
    errors::unexpected,
    robot::{Robot, find},
};

/// A robot, the name of a built-in one, or the path of a profile.
pub(crate) enum RobotArgument<'py> {
    Robot(Bound<'py, Robot>),
    Path(PathBuf),
}

impl<'py> FromPyObject<'_, 'py> for RobotArgument<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(robot) = value.cast::<Robot>() {
            return Ok(Self::Robot(robot.to_owned()));
        }
        let expected = "a Robot, the name of a built-in one or the path of a profile";
        value.extract().map(Self::Path).map_err(|_| unexpected("robot", &value, expected))
    }
}

impl RobotArgument<'_> {
    pub(crate) fn model(&self, py: Python<'_>) -> PyResult<Model> {
        match self {
            Self::Robot(robot) => Ok(robot.get().model.as_ref().clone()),
            Self::Path(name) => find(py, name),
        }
    }
}

const SHAPES: [(&str, BlendShape); 4] = [
    ("iiwa", BlendShape::Iiwa),
    ("alpha", BlendShape::Alpha(Continuity::Second)),
    ("min-acceleration", BlendShape::MinAcceleration),
    ("circle", BlendShape::Circle),
];

const SEARCHES: [(&str, BlendSearch); 3] = [
    ("first-crossing", BlendSearch::FirstCrossing),
    ("algorithm-1", BlendSearch::Algorithm1),
    ("algorithm-2", BlendSearch::Algorithm2),
];

/// The option name of a blend shape.
pub(crate) fn shape_name(shape: BlendShape) -> &'static str {
    SHAPES.iter().find(|(_, known)| *known == shape).map_or("iiwa", |(name, _)| name)
}

/// The option name of a blend search.
pub(crate) fn search_name(search: BlendSearch) -> &'static str {
    SEARCHES.iter().find(|(_, known)| *known == search).map_or("first-crossing", |(name, _)| name)
}

/// The value of an option name.
fn word<T: Copy>(option: &str, word: &str, known: &[(&str, T)]) -> PyResult<T> {
    known.iter().find(|(name, _)| *name == word).map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<_> = known.iter().map(|(name, _)| format!("'{name}'")).collect();
        PyValueError::new_err(format!("{option} is '{word}'; {} are known", names.join(", ")))
    })
}

/// Options for reading a recording, from option names.
pub(crate) fn log_options(unit: Option<&str>, positions: &str) -> PyResult<LogOptions> {
    let units = [("rad", AngleUnit::Radians), ("deg", AngleUnit::Degrees)];
    let kinds = [("measured", Positions::Measured), ("commanded", Positions::Commanded)];
    let options = LogOptions::default().with_positions(word("positions", positions, &kinds)?);
    let unit = unit.map(|unit| word("unit", unit, &units)).transpose()?;
    Ok(unit.map_or(options, |unit| options.with_unit(unit)))
}

/// Planning options from option names.
pub(crate) fn plan_options(
    timing: &str,
    blend_shape: &str,
    blend_search: &str,
    samples: i64,
) -> PyResult<PlanOptions> {
    let samples =
        u32::try_from(samples).ok().filter(|it| (2..=100_000).contains(it)).ok_or_else(|| {
            PyValueError::new_err(format!("samples is {samples}; from 2 to 100000 are possible"))
        })?;
    let timing = word(
        "timing",
        timing,
        &[
            ("jerk", Timing::jerk_limited()),
            ("sunrise", Timing::Sunrise(JerkOptions::default())),
            ("acceleration", Timing::Acceleration(SweepOptions { samples: samples as usize })),
        ],
    )?;
    let blend_shape = word("blend_shape", blend_shape, &SHAPES)?;
    let blend_search = word("blend_search", blend_search, &SEARCHES)?;
    Ok(PlanOptions { path: PathOptions { blend_shape, blend_search }, timing, samples })
}
