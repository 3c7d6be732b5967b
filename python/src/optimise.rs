//! Programs that are changed to be faster.

use std::sync::Arc;

use iiwa_optimise::{Freedom, Optimiser, Optimum as Found};
use iiwa_plan::Plan as Planned;
use iiwa_traj::Trajectory;
use pyo3::{exceptions::PyValueError, prelude::*};

use crate::{
    options::RobotArgument,
    program::Program,
    scene::Scene,
    search::{SceneOfSearch, at_least_0, search},
};

/// The fastest version of a program that was found: the result of `optimise`.
///
/// >>> import iiwasim as iw
/// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
/// >>> iw.optimise(iw.Program(motions, start_deg=[0] * 7), free=['blends'])
/// <iiwasim.Optimum ... -> ... s, 1 change>
#[pyclass(frozen, get_all, module = "iiwasim")]
pub(crate) struct Optimum {
    /// The changed program; without changes, equal to the given one.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> iw.optimise(program, free=['blends']).program
    /// <iiwasim.Program 2 motions, lbr_iiwa_7_r800>
    program: Py<Program>,
    /// The cycle time of the given program.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> iw.optimise(program, free=['blends']).cycle_time_s > 1
    /// True
    cycle_time_s: f64,
    /// The cycle time of the changed program.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> optimum = iw.optimise(program, free=['blends'])
    /// >>> optimum.changed_cycle_time_s < optimum.cycle_time_s
    /// True
    changed_cycle_time_s: f64,
    /// A line of text for each change.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> iw.optimise(program, free=['blends']).changes
    /// ['motion 1: stop -> blend 50 mm']
    changes: Vec<String>,
    /// The number of plans that were compared.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> iw.optimise(program, free=['blends']).plans > 5
    /// True
    plans: u64,
    /// Lower bound of the cycle time with any E1 in whole degrees from the given ones, or in larger
    /// steps in a long program; None if it is not known.
    ///
    /// >>> import iiwasim as iw
    /// >>> optimum = iw.optimise(iw.Program.load('fixtures/production/insert-a-peg.json'))
    /// >>> optimum.lower_bound_s <= optimum.changed_cycle_time_s < optimum.lower_bound_s + 0.002
    /// True
    lower_bound_s: Option<f64>,
    /// False if the budget ended the rounds of changes.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> iw.optimise(program, free=['blends'], budget=1).complete
    /// False
    complete: bool,
}

#[pymethods]
impl Optimum {
    fn __repr__(&self) -> String {
        let Self { cycle_time_s, changed_cycle_time_s, changes, .. } = self;
        let count = changes.len();
        let s = if count == 1 { "" } else { "s" };
        format!(
            "<iiwasim.Optimum {cycle_time_s:.3} -> {changed_cycle_time_s:.3} s, {count} change{s}>"
        )
    }
}

/// Changes a program so that it is faster.
///
/// `free` names the kinds of changes: `'e1'`, elbow angles at targets, with which lines, circles
/// and splines keep their TCP paths and programmed speeds; `'blends'`, radii of up to
/// `max_blend_mm`, blends in place of stops, and motions that the program need not wait for;
/// `'speeds'`, speeds of point-to-point motions. Targets, speeds of TCP paths, waits, inputs,
/// outputs, tools and the order of motions are never changed.
///
/// With a `scene`, each motion keeps `min_clearance_mm` from the obstacles, and the arm from
/// itself; for a motion that has less in the unchanged program, that distance is the limit. Without
/// a scene, nothing is checked for collisions. After `budget` plans, no further round of changes
/// begins; plans before the first round, which turn elbow angles of several groups of motions
/// together, do not count. `progress(plans)` is called from time to time; Ctrl-C interrupts the
/// search.
///
/// >>> import iiwasim as iw
/// >>> program = iw.Program.load('fixtures/pick-and-place.json')
/// >>> optimum = iw.optimise(program, free=['e1', 'blends', 'speeds'])
/// >>> optimum.changed_cycle_time_s < 0.85 * optimum.cycle_time_s
/// True
/// >>> abs(iw.plan(optimum.program).cycle_time_s - optimum.changed_cycle_time_s) < 1e-9
/// True
#[pyfunction]
#[pyo3(signature = (
    program, *, free = vec!["e1".to_owned()], robot = None, timing = "sunrise",
    max_blend_mm = 50.0, scene = None, min_clearance_mm = 10.0, budget = 50_000, progress = None
))]
#[expect(clippy::too_many_arguments, reason = "they are options by keyword in Python")]
pub(crate) fn optimise(
    py: Python<'_>,
    program: &Bound<'_, Program>,
    free: Vec<String>,
    robot: Option<RobotArgument<'_>>,
    timing: &str,
    max_blend_mm: f64,
    scene: Option<&Bound<'_, Scene>>,
    min_clearance_mm: f64,
    budget: u64,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Optimum> {
    let freedom = freedom(&free)?;
    at_least_0("max_blend_mm", max_blend_mm)?;
    let given = program.get();
    let scene = SceneOfSearch::new(py, given, scene, min_clearance_mm)?;
    let work = move |optimiser: &Optimiser, planned: &Planned| {
        let optimiser = optimiser
            .clone()
            .with_freedom(freedom)
            .with_max_blend_mm(max_blend_mm)
            .with_budget(budget);
        let Some(scene) = scene else { return Ok(optimiser.optimise(&planned.program)?) };
        let arm = scene.arm(planned);
        let clearances = scene.clearances(&arm, planned)?;
        let rule = |trajectory: &Trajectory| clearances.allow(trajectory);
        Ok(optimiser.optimise_within(&planned.program, &rule)?)
    };
    let (found, planned) = search(py, given, robot, timing, progress, work)?;
    optimum(py, given, &planned, found)
}

/// Kinds of changes, from their names.
fn freedom(names: &[String]) -> PyResult<Freedom> {
    let mut freedom = Freedom::NONE;
    for name in names {
        match name.as_str() {
            "e1" => freedom.elbows = true,
            "blends" => freedom.blends = true,
            "speeds" => freedom.speeds = true,
            _ => {
                return Err(PyValueError::new_err(format!(
                    "free has '{name}'; 'e1', 'blends', 'speeds' are known"
                )));
            }
        }
    }
    Ok(freedom)
}

fn optimum(py: Python<'_>, given: &Program, planned: &Planned, found: Found) -> PyResult<Optimum> {
    let changes = found.changes.iter();
    let changes = changes.map(|change| format!("motion {}: {change}", change.motion)).collect();
    let program = Arc::new(found.program);
    let program = Program::planned(&given.source, &program, planned.robot(), given.origin);
    Ok(Optimum {
        program: Py::new(py, program)?,
        cycle_time_s: found.cycle_time_s,
        changed_cycle_time_s: found.changed_cycle_time_s,
        changes,
        plans: found.plans,
        lower_bound_s: found.lower_bound.map(|bound| bound.cycle_time_s),
        complete: found.is_complete,
    })
}
