//! Robot base positions at which programs are fast.

use std::sync::Arc;

use iiwa_optimise::{Optimiser, Place, PlaceGrid, TimedPlace};
use iiwa_plan::Plan as Planned;
use iiwa_traj::Trajectory;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::{exceptions::PyValueError, prelude::*};

use crate::{
    options::RobotArgument,
    program::Program,
    scene::Scene,
    search::{SceneOfSearch, SearchFailure, search},
};

/// A shift in mm along x, y and z, and a rotation about z in degrees.
type PlaceNumbers = (f64, f64, f64, f64);

/// Cycle times of a program at robot base positions: the result of `place`.
///
/// >>> import iiwasim as iw
/// >>> program = iw.Program.load('fixtures/pick-and-place.json')
/// >>> iw.place(program, x_mm=(-50, 50), y_mm=0, steps=3)
/// <iiwasim.PlaceMap ... -> ... s, 3 places>
#[pyclass(frozen, module = "iiwasim")]
pub(crate) struct PlaceMap {
    /// The program at the best place; without one, equal to the given program.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program.load('fixtures/pick-and-place.json')
    /// >>> iw.place(program, x_mm=(-50, 50), y_mm=0, steps=3).program
    /// <iiwasim.Program 8 motions, lbr_iiwa_7_r800>
    #[pyo3(get)]
    program: Py<Program>,
    /// The cycle time at the present place.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program.load('fixtures/pick-and-place.json')
    /// >>> places = iw.place(program, x_mm=(-50, 50), y_mm=0, steps=3)
    /// >>> abs(places.cycle_time_s - iw.plan(program).cycle_time_s) < 1e-9
    /// True
    #[pyo3(get)]
    cycle_time_s: f64,
    /// The cycle time of `program`.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program.load('fixtures/pick-and-place.json')
    /// >>> places = iw.place(program, x_mm=(-50, 50), y_mm=0, steps=3)
    /// >>> places.changed_cycle_time_s < places.cycle_time_s
    /// True
    #[pyo3(get)]
    changed_cycle_time_s: f64,
    best: Option<TimedPlace>,
    places: Vec<TimedPlace>,
    /// The number of plans that were compared.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program.load('fixtures/pick-and-place.json')
    /// >>> iw.place(program, x_mm=(-50, 50), y_mm=0, steps=3).plans > 3
    /// True
    #[pyo3(get)]
    plans: u64,
}

#[pymethods]
impl PlaceMap {
    /// The best place: shifts along x, y and z in mm, rotation about z in degrees. None if no place
    /// that keeps the clearances saves a millisecond.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program.load('fixtures/pick-and-place.json')
    /// >>> [round(number) for number in iw.place(program, x_mm=(-50, 50), y_mm=0, steps=3).best]
    /// [-50, 0, 0, 0]
    #[getter]
    fn best(&self) -> Option<PlaceNumbers> {
        self.best.map(|best| numbers(&best.place).into())
    }

    /// The places on the grid, (n, 4): each as in `best`. x changes fastest, then y, then z.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program.load('fixtures/pick-and-place.json')
    /// >>> iw.place(program, x_mm=(-50, 50), y_mm=0, steps=3).places[:, 0].round()
    /// array([-50.,   0.,  50.])
    #[getter]
    fn places<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let all: Vec<f64> = self.places.iter().flat_map(|it| numbers(&it.place)).collect();
        PyArray1::from_vec(py, all).reshape([self.places.len(), 4])
    }

    /// The cycle times at `places`; not a number where the robot cannot execute the program.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program.load('fixtures/pick-and-place.json')
    /// >>> int(iw.place(program, x_mm=(-50, 50), y_mm=0, steps=3).cycle_times_s.argmin())
    /// 0
    #[getter]
    fn cycle_times_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let times = self.places.iter().map(|it| it.cycle_time_s.unwrap_or(f64::NAN));
        PyArray1::from_vec(py, times.collect())
    }

    /// True at those of `places` where the arm is too near to an obstacle or to itself. Without a
    /// scene, False everywhere.
    ///
    /// >>> import iiwasim as iw, json
    /// >>> program = iw.Program.load('fixtures/pick-and-place.json')
    /// >>> wall = {'name': 'wall', 'type': 'plane', 'point_mm': [-150, 0, 0], 'normal': [1, 0, 0]}
    /// >>> scene = iw.Scene.from_json(json.dumps({'version': 1, 'obstacles': [wall]}))
    /// >>> iw.place(program, x_mm=(-100, 100), y_mm=0, steps=3, scene=scene).too_near
    /// array([ True, False, False])
    #[getter]
    fn too_near<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, self.places.iter().map(|it| it.is_rejected))
    }

    fn __repr__(&self) -> String {
        let (before_s, after_s) = (self.cycle_time_s, self.changed_cycle_time_s);
        let count = self.places.len();
        let s = if count == 1 { "" } else { "s" };
        format!("<iiwasim.PlaceMap {before_s:.3} -> {after_s:.3} s, {count} place{s}>")
    }
}

/// Shifts in mm and rotation in degrees.
fn numbers(place: &Place) -> [f64; 4] {
    let [x, y, z] = place.shift_m.map(|shift_m| 1e3 * shift_m);
    [x, y, z, place.yaw_rad.to_degrees()]
}

/// A range of values, or a single one.
#[derive(FromPyObject)]
pub(crate) enum RangeArgument {
    #[pyo3(transparent)]
    Value(f64),
    #[pyo3(transparent)]
    Range((f64, f64)),
}

impl RangeArgument {
    /// Returns `steps` values along the range, multiplied by `unit`.
    fn values(&self, name: &str, steps: usize, unit: f64) -> PyResult<Vec<f64>> {
        let (from, to) = match *self {
            Self::Value(value) => (value, value),
            Self::Range(range) => range,
        };
        if !(from.is_finite() && to.is_finite() && from <= to) {
            return Err(PyValueError::new_err(format!(
                "{name} is ({from}, {to}); a number or a range from a smaller to a larger one is \
                 needed"
            )));
        }
        Ok(PlaceGrid::axis([from, to], steps).into_iter().map(|value| value * unit).collect())
    }
}

/// Searches for the robot base position at which a program is fastest.
///
/// The robot's base is moved by `x_mm`, `y_mm` and `z_mm` along its axes, and turned by `yaw_deg`
/// about z: each of them a number, or a tuple of two, a range with `steps` values. By default, x
/// and y are (-100, 100), z and yaw 0. The program is planned exactly at each place, and around the
/// best one in ever smaller steps. Bases, frames and targets keep their places in the cell; joint
/// positions and elbow angles stay as they are.
///
/// With a `scene`, each motion keeps `min_clearance_mm` from the obstacles, and the arm from
/// itself; a motion that has less in the given program may have less only between the same part of
/// the arm and the same obstacle. Obstacles keep their places in the cell, except those named in
/// `with_robot`, which move with the robot base; they are not checked against each other. Without a
/// scene, places are not checked for collisions. `progress(plans)` is called from time to time;
/// Ctrl-C interrupts the search.
///
/// >>> import iiwasim as iw
/// >>> places = iw.place(
/// ...     iw.Program.load('fixtures/pick-and-place.json'), x_mm=(-50, 50), y_mm=0, steps=3)
/// >>> abs(iw.plan(places.program).cycle_time_s - places.changed_cycle_time_s) < 1e-9
/// True
#[pyfunction]
#[pyo3(signature = (
    program, *, x_mm = RangeArgument::Range((-100.0, 100.0)),
    y_mm = RangeArgument::Range((-100.0, 100.0)), z_mm = RangeArgument::Value(0.0),
    yaw_deg = RangeArgument::Value(0.0), steps = 5, robot = None, timing = "sunrise",
    scene = None, min_clearance_mm = 10.0, with_robot = Vec::new(), progress = None
))]
#[expect(clippy::too_many_arguments, reason = "they are options by keyword in Python")]
pub(crate) fn place(
    py: Python<'_>,
    program: &Bound<'_, Program>,
    x_mm: RangeArgument,
    y_mm: RangeArgument,
    z_mm: RangeArgument,
    yaw_deg: RangeArgument,
    steps: usize,
    robot: Option<RobotArgument<'_>>,
    timing: &str,
    scene: Option<&Bound<'_, Scene>>,
    min_clearance_mm: f64,
    with_robot: Vec<String>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<PlaceMap> {
    const MOST: usize = PlaceGrid::MOST_PLACES;

    if !(2..=100).contains(&steps) {
        return Err(PyValueError::new_err(format!("steps is {steps}; 2 to 100 are possible")));
    }
    let grid = PlaceGrid {
        shifts_m: [
            x_mm.values("x_mm", steps, 1e-3)?,
            y_mm.values("y_mm", steps, 1e-3)?,
            z_mm.values("z_mm", steps, 1e-3)?,
        ],
        yaws_rad: yaw_deg.values("yaw_deg", steps, 1_f64.to_radians())?,
    };
    let count = grid.count();
    if count > MOST {
        return Err(PyValueError::new_err(format!(
            "the grid has {count} places; at most {MOST} are possible"
        )));
    }
    let given = program.get();
    let with_robot = match scene {
        Some(scene) => scene.get().parsed.indices_of(&with_robot),
        None if with_robot.is_empty() => Ok(Vec::new()),
        None => return Err(PyValueError::new_err("with_robot names obstacles: give their scene")),
    };
    let with_robot =
        with_robot.map_err(|error| PyValueError::new_err(format!("with_robot: {error}")))?;
    let scene = SceneOfSearch::new(py, given, scene, min_clearance_mm)?;
    let work = move |optimiser: &Optimiser, planned: &Planned| {
        if grid.turns_gravity(&planned.program.workcell.mount) {
            return Err(SearchFailure::Unsuitable(
                "yaw_deg turns a robot that is mounted neither upright nor hanging, and gravity \
                 with it: state the other mounting in the program"
                    .to_owned(),
            ));
        }
        let Some(scene) = scene else { return Ok(optimiser.place(&planned.program, &grid)?) };
        let arm = scene.arm(planned);
        let clearances = scene.clearances(&arm, planned)?;
        let rule = |place: &Place, trajectory: &Trajectory| {
            clearances.allow_elsewhere(&place.cell(), &with_robot, trajectory)
        };
        Ok(optimiser.place_within(&planned.program, &grid, &rule)?)
    };
    let (found, planned) = search(py, given, robot, timing, progress, work)?;
    let changed_cycle_time_s = found.changed_cycle_time_s();
    let program = Arc::new(found.program);
    let program = Program::planned(&given.source, &program, planned.robot(), given.origin);
    Ok(PlaceMap {
        program: Py::new(py, program)?,
        cycle_time_s: found.cycle_time_s,
        changed_cycle_time_s,
        best: found.best,
        places: found.places,
        plans: found.plans,
    })
}
