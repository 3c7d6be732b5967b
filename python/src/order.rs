//! Programs with their tasks in the fastest order.

use std::sync::Arc;

use iiwa_optimise::Optimiser;
use iiwa_plan::Plan as Planned;
use iiwa_program::Program as Motions;
use iiwa_traj::Trajectory;
use pyo3::prelude::*;

use crate::{
    options::RobotArgument,
    program::Program,
    scene::Scene,
    search::{SceneOfSearch, search},
};

/// The fastest order of the tasks of a program: the result of `order`.
///
/// >>> import iiwasim as iw
/// >>> iw.order(iw.Program.load('fixtures/screws.json'))
/// <iiwasim.TaskOrder ... -> ... s, 8 tasks>
#[pyclass(frozen, get_all, module = "iiwasim")]
pub(crate) struct TaskOrder {
    /// The program with its tasks in this order.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.order(iw.Program.load('fixtures/screws.json')).program
    /// <iiwasim.Program 33 motions, lbr_iiwa_7_r800>
    program: Py<Program>,
    /// The cycle time of the given program.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program.load('fixtures/screws.json')
    /// >>> abs(iw.order(program).cycle_time_s - iw.plan(program).cycle_time_s) < 1e-9
    /// True
    cycle_time_s: f64,
    /// The cycle time with the tasks in this order.
    ///
    /// >>> import iiwasim as iw
    /// >>> order = iw.order(iw.Program.load('fixtures/screws.json'))
    /// >>> order.changed_cycle_time_s < 0.96 * order.cycle_time_s
    /// True
    changed_cycle_time_s: f64,
    /// The groups of the tasks, in this order.
    ///
    /// >>> import iiwasim as iw
    /// >>> sorted(iw.order(iw.Program.load('fixtures/screws.json')).tasks[:2])
    /// ['screw 1', 'screw 2']
    tasks: Vec<String>,
    /// The number of plans that were compared.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.order(iw.Program.load('fixtures/screws.json')).plans > 50
    /// True
    plans: u64,
    /// True if all allowed orders were compared.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.order(iw.Program.load('fixtures/screws.json')).complete
    /// True
    complete: bool,
}

#[pymethods]
impl TaskOrder {
    fn __repr__(&self) -> String {
        let Self { cycle_time_s, changed_cycle_time_s, tasks, .. } = self;
        let count = tasks.len();
        let s = if count == 1 { "" } else { "s" };
        format!(
            "<iiwasim.TaskOrder {cycle_time_s:.3} -> {changed_cycle_time_s:.3} s, {count} task{s}>"
        )
    }
}

/// Searches for the order of tasks in which a program is fastest.
///
/// The key `tasks` of the program lists groups of motions that may be executed in another order.
/// Paths within tasks stay as they are, except in blends between tasks. Up to 16 tasks, all allowed
/// orders are compared. With a `scene`, each motion keeps its clearance as for `optimise`.
/// `progress(plans)` is called from time to time; Ctrl-C interrupts the search.
///
/// >>> import iiwasim as iw
/// >>> order = iw.order(iw.Program.load('fixtures/screws.json'))
/// >>> abs(iw.plan(order.program).cycle_time_s - order.changed_cycle_time_s) < 1e-9
/// True
#[pyfunction]
#[pyo3(signature = (
    program, *, robot = None, timing = "sunrise", scene = None, min_clearance_mm = 10.0,
    progress = None
))]
pub(crate) fn order(
    py: Python<'_>,
    program: &Bound<'_, Program>,
    robot: Option<RobotArgument<'_>>,
    timing: &str,
    scene: Option<&Bound<'_, Scene>>,
    min_clearance_mm: f64,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<TaskOrder> {
    let given = program.get();
    let scene = SceneOfSearch::new(py, given, scene, min_clearance_mm)?;
    let work = move |optimiser: &Optimiser, planned: &Planned| {
        let Some(scene) = scene else { return Ok(optimiser.order(&planned.program)?) };
        let arm = scene.arm(planned);
        let clearances = scene.clearances(&arm, planned)?;
        let rule = |part: &Motions, trajectory: &Trajectory, origins: &[usize]| {
            scene.allow_reordered(&clearances, (part, trajectory, origins))
        };
        Ok(optimiser.order_within(&planned.program, &rule)?)
    };
    let (found, planned) = search(py, given, robot, timing, progress, work)?;
    let tasks = planned.program.tasks().unwrap_or_default();
    let groups = found.order.iter().filter_map(|task| Some(tasks.get(*task)?.group.clone()));
    let program = Arc::new(found.program);
    let program = Program::planned(&given.source, &program, planned.robot(), given.origin);
    Ok(TaskOrder {
        program: Py::new(py, program)?,
        cycle_time_s: found.cycle_time_s,
        changed_cycle_time_s: found.changed_cycle_time_s,
        tasks: groups.collect(),
        plans: found.plans,
        complete: found.is_exact,
    })
}
