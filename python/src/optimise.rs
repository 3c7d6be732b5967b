//! Programs that are changed to be faster.

use std::sync::{Arc, atomic::Ordering};

use iiwa_optimise::{Freedom, Optimiser, Optimum as Found};
use iiwa_plan::{Error, Plan as Planned, PlanRequest};
use iiwa_report::carried;
use iiwa_scene::{AllowedClearances, ArmInScene};
use iiwa_traj::{PlanError, Trajectory};
use pyo3::{
    exceptions::{PyRuntimeError, PyValueError},
    prelude::*,
};
use rayon::ThreadPoolBuilder;

use crate::{
    errors::{plan_error, plan_error_in},
    options::{RobotArgument, plan_options},
    program::Program,
    scene::Scene,
    work::interruptible,
};

/// The fastest version of a program that was found: the result of `optimise`.
///
/// >>> import iiwasim as iw
/// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
/// >>> iw.optimise(iw.Program(motions, start_deg=[0] * 7), free=['blends'])
/// <iiwasim.Optimum ... -> ... s, 1 change>
#[pyclass(frozen, module = "iiwasim")]
pub(crate) struct Optimum {
    program: Py<Program>,
    cycle_time_s: f64,
    changed_cycle_time_s: f64,
    changes: Vec<String>,
    plans: u64,
    complete: bool,
}

#[pymethods]
impl Optimum {
    /// The changed program; without changes, equal to the given one.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> iw.optimise(program, free=['blends']).program
    /// <iiwasim.Program 2 motions, lbr_iiwa_7_r800>
    #[getter]
    fn program(&self, py: Python<'_>) -> Py<Program> {
        self.program.clone_ref(py)
    }

    /// The cycle time of the given program.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> iw.optimise(program, free=['blends']).cycle_time_s > 1
    /// True
    #[getter]
    fn cycle_time_s(&self) -> f64 {
        self.cycle_time_s
    }

    /// The cycle time of the changed program.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> optimum = iw.optimise(program, free=['blends'])
    /// >>> optimum.changed_cycle_time_s < optimum.cycle_time_s
    /// True
    #[getter]
    fn changed_cycle_time_s(&self) -> f64 {
        self.changed_cycle_time_s
    }

    /// A line of text for each change.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> iw.optimise(program, free=['blends']).changes
    /// ['motion 1: stop -> blend 50 mm']
    #[getter]
    fn changes(&self) -> Vec<String> {
        self.changes.clone()
    }

    /// The number of plans that were compared.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> iw.optimise(program, free=['blends']).plans > 5
    /// True
    #[getter]
    fn plans(&self) -> u64 {
        self.plans
    }

    /// False if the budget ended the search.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[30, 20] + [0] * 5)]
    /// >>> program = iw.Program(motions, start_deg=[0] * 7)
    /// >>> iw.optimise(program, free=['blends'], budget=1).complete
    /// False
    #[getter]
    fn complete(&self) -> bool {
        self.complete
    }

    fn __repr__(&self) -> String {
        let Self { cycle_time_s, changed_cycle_time_s, changes, .. } = self;
        let count = changes.len();
        let s = if count == 1 { "" } else { "s" };
        format!(
            "<iiwasim.Optimum {cycle_time_s:.3} -> {changed_cycle_time_s:.3} s, {count} change{s}>"
        )
    }
}

/// The search ended with an error, or the unchanged program touches something.
enum SearchFailure {
    Plan(PlanError),
    Contact(String),
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
/// begins. `progress(plans)` is called from time to time; Ctrl-C interrupts the search.
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
    for (name, value) in [("max_blend_mm", max_blend_mm), ("min_clearance_mm", min_clearance_mm)] {
        if !(value.is_finite() && value >= 0.0) {
            return Err(PyValueError::new_err(format!("{name} is {value}; at least 0 is needed")));
        }
    }
    let given = program.get();
    let robot = robot.map(|robot| robot.model(py)).transpose()?.unwrap_or_else(|| given.model());
    let options = plan_options(timing, "iiwa", "first-crossing", 100)?;
    let request = PlanRequest { robot: Some(robot), options, ..PlanRequest::default() };
    let scene = scene
        .map(|scene| {
            let shapes = carried(&given.source).map_err(|error| plan_error(py, &error))?;
            PyResult::Ok((Arc::clone(&scene.get().parsed), shapes))
        })
        .transpose()?;
    let source = Arc::clone(&given.source);
    // A local pool: threads of the global pool do not exist in a forked process.
    let pool = ThreadPoolBuilder::new()
        .build()
        .map_err(|error| PyRuntimeError::new_err(format!("cannot start the threads: {error}")))?;
    let plan = move |stop| request.plan_with(&mut None, &source, &stop);
    let planned = interruptible(py, plan, |_| Ok(()))?;
    let planned = planned.map_err(|error| plan_error_in(py, &error, given.text(), given.origin))?;
    let optimiser = Optimiser::new(planned.robot().clone(), options)
        .with_freedom(freedom)
        .with_max_blend_mm(max_blend_mm)
        .with_budget(budget);
    let plans = optimiser.plan_count();
    let search = move |stop| {
        let optimiser = optimiser.interrupted_by(stop);
        let search = || match &scene {
            Some((scene, shapes)) => {
                let arm = ArmInScene::new(planned.robot(), scene).carrying(shapes);
                within(&optimiser, &planned, &arm, 1e-3 * min_clearance_mm)
            }
            None => optimiser.optimise(&planned.program).map_err(SearchFailure::Plan),
        };
        let found = pool.install(search);
        (found, planned)
    };
    let tick = |_: Python<'_>| {
        progress.iter().try_for_each(|call| call.call1((plans.load(Ordering::Relaxed),)).map(drop))
    };
    let (found, planned) = interruptible(py, search, tick)?;
    match found {
        Ok(found) => optimum(py, given, &planned, found),
        Err(SearchFailure::Plan(error)) => {
            let error = Error::plan(error, &planned.program.sources, given.text());
            Err(plan_error_in(py, &error, given.text(), given.origin))
        }
        Err(SearchFailure::Contact(message)) => Err(PyValueError::new_err(message)),
    }
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

/// Searches among the changes that keep the clearances in a scene.
fn within(
    optimiser: &Optimiser,
    planned: &Planned,
    arm: &ArmInScene,
    min_m: f64,
) -> Result<Found, SearchFailure> {
    let clearances =
        AllowedClearances::new(arm, &planned.trajectory, min_m).map_err(|contact| {
            SearchFailure::Contact(format!(
                "the arm touches {} in motion {}: changes can be checked only for a program that \
                 touches no obstacle",
                arm.name_of(contact.clearance.other),
                contact.motion,
            ))
        })?;
    let rule = |trajectory: &Trajectory| clearances.allow(trajectory);
    optimiser.optimise_within(&planned.program, &rule).map_err(SearchFailure::Plan)
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
        complete: found.is_complete,
    })
}
