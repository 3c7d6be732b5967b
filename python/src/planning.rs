//! Planning of one or many programs.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread::available_parallelism,
};

use iiwa_kin::Robot as Model;
use iiwa_plan::{Error, PlanOptions, PlanRequest, ProgramSource};
use iiwa_program::{MAX_TORQUE_LIMIT, MIN_OVERRIDE, MIN_TORQUE_LIMIT};
use iiwa_traj::Planner;
use pyo3::{
    exceptions::{PyRuntimeError, PyValueError},
    prelude::*,
    types::PyList,
};
use rayon::{ThreadPoolBuilder, prelude::*};

use crate::{
    errors::{TextOrigin, plan_error_in, unexpected},
    options::{RobotArgument, plan_options},
    plan::Plan,
    program::Program,
    work::interruptible,
};

/// A program and the request for its plan.
struct PlanTask {
    source: Arc<ProgramSource>,
    origin: TextOrigin,
    request: PlanRequest,
}

impl PlanTask {
    fn new(
        program: &Program,
        robot: Option<&Model>,
        overrides: Overrides,
        options: PlanOptions,
    ) -> Self {
        let request = PlanRequest {
            robot: Some(robot.cloned().unwrap_or_else(|| program.model())),
            torque_limit_rel: overrides.torque_limit_rel,
            speed_override: overrides.speed_override,
            options,
            ..PlanRequest::default()
        };
        Self { source: Arc::clone(&program.source), origin: program.origin, request }
    }

    /// Plans the program with a planner whose memory is reused.
    fn plan(
        &self,
        planner: &mut Option<Planner>,
        stop: &Arc<AtomicBool>,
    ) -> Result<iiwa_plan::Plan, Error> {
        self.request.plan_with(planner, &self.source, stop)
    }

    fn result(
        self,
        py: Python<'_>,
        planned: Result<iiwa_plan::Plan, Error>,
    ) -> Result<Plan, PyErr> {
        match planned {
            Ok(plan) => Ok(Plan::new(self.source, self.origin, plan)),
            Err(error) => Err(plan_error_in(py, &error, self.source.text.as_read(), self.origin)),
        }
    }
}

/// Options that replace those of the program.
#[derive(Clone, Copy)]
struct Overrides {
    /// Torque limit as a share of the robot's torque limits.
    torque_limit_rel: Option<f64>,
    /// Override of the controller, as a share.
    speed_override: Option<f64>,
}

impl Overrides {
    fn new(limit_torque_percent: Option<f64>, override_percent: Option<f64>) -> PyResult<Self> {
        let torque = (MIN_TORQUE_LIMIT, MAX_TORQUE_LIMIT);
        Ok(Self {
            torque_limit_rel: share("limit_torque_percent", limit_torque_percent, torque)?,
            speed_override: share("override_percent", override_percent, (MIN_OVERRIDE, 1.0))?,
        })
    }
}

/// Converts a percentage to a share, and checks it against bounds, which are shares.
fn share(name: &str, percent: Option<f64>, (min, max): (f64, f64)) -> PyResult<Option<f64>> {
    let Some(percent) = percent else { return Ok(None) };
    let share = percent / 100.0;
    if !(min..=max).contains(&share) {
        let (min_percent, max_percent) = (100.0 * min, 100.0 * max);
        return Err(PyValueError::new_err(format!(
            "{name} is {percent}; from {min_percent} to {max_percent} are possible"
        )));
    }
    Ok(Some(share))
}

/// Lowers the priority of this thread if planning `takes_all` cores, so that Python threads keep
/// running.
fn give_way(takes_all: bool) {
    // On other systems the priority of the whole process would change.
    #[cfg(target_os = "linux")]
    if takes_all {
        let _ = rustix::process::nice(5);
    }
    #[cfg(not(target_os = "linux"))]
    let _ = takes_all;
}

/// Plans a program: the fastest motion along its path within the velocity, acceleration and, with
/// `timing='jerk'`, jerk limits. With `timing='sunrise'`, PTP motions from rest to rest start and
/// stop as observed in Sunrise, and spline speeds follow a model.
///
/// `robot`, a `Robot`, a name or the path of a profile, replaces the robot of the program.
/// `limit_torque_percent` also limits torques. `override_percent`, the override of the controller,
/// replaces the override of the program: it slows down motions, but neither the standstill after
/// stops nor waits. Raises `ProgramError` with the motion and its argument, or with line and column
/// of a program that was read from a text. Ctrl-C interrupts planning.
///
/// >>> import iiwasim as iw
/// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
/// >>> plan = iw.plan(program)
/// >>> other = iw.plan(program, robot='lbr_iiwa_14_r820', timing='acceleration')
/// >>> other.cycle_time_s < plan.cycle_time_s * 2
/// True
/// >>> round(iw.plan(program, override_percent=50).motion_time_s / plan.motion_time_s, 3)
/// 2.0
#[pyfunction]
#[pyo3(signature = (
    program, *, robot = None, timing = "sunrise", blend_shape = "iiwa",
    blend_search = "first-crossing", samples = 100, limit_torque_percent = None,
    override_percent = None
))]
#[expect(clippy::too_many_arguments, reason = "they are options by keyword in Python")]
pub(crate) fn plan(
    py: Python<'_>,
    program: &Bound<'_, Program>,
    robot: Option<RobotArgument<'_>>,
    timing: &str,
    blend_shape: &str,
    blend_search: &str,
    samples: i64,
    limit_torque_percent: Option<f64>,
    override_percent: Option<f64>,
) -> PyResult<Plan> {
    let options = plan_options(timing, blend_shape, blend_search, samples)?;
    let robot = robot.map(|robot| robot.model(py)).transpose()?;
    let overrides = Overrides::new(limit_torque_percent, override_percent)?;
    let job = PlanTask::new(program.get(), robot.as_ref(), overrides, options);
    let work = move |stop| {
        let planned = job.plan(&mut None, &stop);
        (job, planned)
    };
    let (job, planned) = interruptible(py, work, |_| Ok(()))?;
    job.result(py, planned)
}

/// Plans many programs on all cores, or on `jobs` cores; returns a list of plans in their order.
///
/// The list has an exception in place of the plan of a program that cannot be planned.
/// `progress(done, total)` is called from time to time. Other Python threads run meanwhile: on
/// Linux, planning on all cores runs at low priority. Ctrl-C interrupts planning.
///
/// >>> import iiwasim as iw
/// >>> targets = [10, 20, 700]
/// >>> programs = [iw.Program([iw.ptp(deg=[a] + [0] * 6)], start_deg=[0] * 7) for a in targets]
/// >>> [type(plan).__name__ for plan in iw.plan_all(programs)]
/// ['Plan', 'Plan', 'ProgramError']
#[pyfunction]
#[pyo3(signature = (
    programs, *, robot = None, timing = "sunrise", blend_shape = "iiwa",
    blend_search = "first-crossing", samples = 100, limit_torque_percent = None,
    override_percent = None, jobs = None, progress = None
))]
#[expect(clippy::too_many_arguments, reason = "they are options by keyword in Python")]
pub(crate) fn plan_all<'py>(
    py: Python<'py>,
    programs: &Bound<'py, PyAny>,
    robot: Option<RobotArgument<'py>>,
    timing: &str,
    blend_shape: &str,
    blend_search: &str,
    samples: i64,
    limit_torque_percent: Option<f64>,
    override_percent: Option<f64>,
    jobs: Option<i64>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyList>> {
    let options = plan_options(timing, blend_shape, blend_search, samples)?;
    let robot = robot.map(|robot| robot.model(py)).transpose()?;
    let overrides = Overrides::new(limit_torque_percent, override_percent)?;
    let mut work = Vec::new();
    for (index, program) in programs.try_iter()?.enumerate() {
        let program = program?;
        let program = program
            .cast::<Program>()
            .map_err(|_| unexpected(&format!("programs[{index}]"), &program, "a Program"))?;
        work.push(PlanTask::new(program.get(), robot.as_ref(), overrides, options));
    }
    let total = work.len();
    let cores = available_parallelism().map_or(1, usize::from);
    let threads = match jobs {
        None => cores,
        Some(jobs) => usize::try_from(jobs).ok().filter(|jobs| *jobs > 0).ok_or_else(|| {
            PyValueError::new_err(format!("jobs is {jobs}; at least 1 is needed"))
        })?,
    };
    let takes_all = threads > 1 && threads >= cores;
    // A local pool: threads of the global pool do not exist in a forked process.
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads.min(total.max(1)))
        .start_handler(move |_| give_way(takes_all))
        .build()
        .map_err(|error| PyRuntimeError::new_err(format!("cannot start the threads: {error}")))?;
    let done = Arc::new(AtomicUsize::new(0));
    let counter = Arc::clone(&done);
    let plan_them = move |stop: Arc<AtomicBool>| {
        let plan = |planner: &mut Option<Planner>, job: PlanTask| {
            let planned = job.plan(planner, &stop);
            counter.fetch_add(1, Ordering::Relaxed);
            (job, planned)
        };
        pool.install(|| -> Vec<_> { work.into_par_iter().map_init(|| None, plan).collect() })
    };
    let mut last_report = None;
    let mut report = || -> PyResult<()> {
        let (Some(progress), now) = (&progress, done.load(Ordering::Relaxed)) else {
            return Ok(());
        };
        if last_report.replace(now) != Some(now) {
            progress.call1((now, total))?;
        }
        Ok(())
    };
    let planned = interruptible(py, plan_them, |_| report())?;
    report()?;
    let results = PyList::empty(py);
    for (job, planned) in planned {
        match job.result(py, planned) {
            Ok(plan) => results.append(Bound::new(py, plan)?)?,
            Err(error) => results.append(error.into_value(py))?,
        }
    }
    Ok(results)
}
