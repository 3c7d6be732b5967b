//! Searches for faster programs: the plan that they begin with, progress, Ctrl-C and errors.

use std::sync::{Arc, atomic::Ordering};

use iiwa_optimise::Optimiser;
use iiwa_plan::{Error, Plan as Planned, PlanRequest, ProgramSource};
use iiwa_program::Program as Motions;
use iiwa_report::carried;
use iiwa_scene::{AllowedClearances, ArmInScene, CarriedBodies, Scene as Obstacles};
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

/// The search ended with an error, or cannot begin with this program.
pub(crate) enum SearchFailure {
    Plan(PlanError),
    Unsuitable(String),
}

impl From<PlanError> for SearchFailure {
    fn from(error: PlanError) -> Self {
        Self::Plan(error)
    }
}

/// Plans a program, and searches from this plan on. Returns what the search finds, and the plan.
pub(crate) fn search<T: Send + 'static>(
    py: Python<'_>,
    given: &Program,
    robot: Option<RobotArgument<'_>>,
    timing: &str,
    progress: Option<Bound<'_, PyAny>>,
    work: impl FnOnce(&Optimiser, &Planned) -> Result<T, SearchFailure> + Send + 'static,
) -> PyResult<(T, Planned)> {
    let robot = robot.map(|robot| robot.model(py)).transpose()?.unwrap_or_else(|| given.model());
    let options = plan_options(timing, "iiwa", "first-crossing", 100)?;
    let request = PlanRequest { robot: Some(robot), options, ..PlanRequest::default() };
    let source = Arc::clone(&given.source);
    // A local pool: threads of the global pool do not exist in a forked process.
    let pool = ThreadPoolBuilder::new()
        .build()
        .map_err(|error| PyRuntimeError::new_err(format!("cannot start the threads: {error}")))?;
    let plan = move |stop| request.plan_with(&mut None, &source, &stop);
    let planned = interruptible(py, plan, |_| Ok(()))?;
    let planned = planned.map_err(|error| plan_error_in(py, &error, given.text(), given.origin))?;
    let optimiser = Optimiser::new(planned.robot().clone(), options);
    let plans = optimiser.plan_count();
    let search = move |stop| {
        let optimiser = optimiser.interrupted_by(stop);
        (pool.install(|| work(&optimiser, &planned)), planned)
    };
    let tick = |_: Python<'_>| {
        progress.iter().try_for_each(|call| call.call1((plans.load(Ordering::Relaxed),)).map(drop))
    };
    let (found, planned) = interruptible(py, search, tick)?;
    match found {
        Ok(found) => Ok((found, planned)),
        Err(SearchFailure::Plan(error)) => {
            let error = Error::plan(error, &planned.program.sources, given.text());
            Err(plan_error_in(py, &error, given.text(), given.origin))
        }
        Err(SearchFailure::Unsuitable(message)) => Err(PyValueError::new_err(message)),
    }
}

/// Scene in which a changed program keeps its clearances.
pub(crate) struct SceneOfSearch {
    scene: Arc<Obstacles>,
    source: Arc<ProgramSource>,
    shapes: CarriedBodies,
    min_m: f64,
}

impl SceneOfSearch {
    pub(crate) fn new(
        py: Python<'_>,
        given: &Program,
        scene: Option<&Bound<'_, Scene>>,
        min_clearance_mm: f64,
    ) -> PyResult<Option<Self>> {
        at_least_0("min_clearance_mm", min_clearance_mm)?;
        let Some(scene) = scene else { return Ok(None) };
        let shapes = carried(&given.source).map_err(|error| plan_error(py, &error))?;
        Ok(Some(Self {
            scene: Arc::clone(&scene.get().parsed),
            source: Arc::clone(&given.source),
            shapes,
            min_m: 1e-3 * min_clearance_mm,
        }))
    }

    /// The arm with the shapes that the unchanged program carries.
    pub(crate) fn arm(&self, planned: &Planned) -> ArmInScene {
        ArmInScene::new(planned.robot(), &self.scene).carrying(&self.shapes)
    }

    /// Clearances of the unchanged program.
    pub(crate) fn clearances<'a>(
        &self,
        arm: &'a ArmInScene,
        planned: &'a Planned,
    ) -> Result<AllowedClearances<'a>, SearchFailure> {
        AllowedClearances::new(arm, &planned.trajectory, self.min_m).map_err(|contact| {
            SearchFailure::Unsuitable(format!(
                "the arm touches {} in motion {}: changes can be checked only for a program that \
                 touches no obstacle",
                arm.name_of(contact.clearance.other),
                contact.motion,
            ))
        })
    }

    /// Returns true if a program keeps the clearances whose entries are those of the unchanged one
    /// in another order.
    pub(crate) fn allow_reordered(
        &self,
        clearances: &AllowedClearances<'_>,
        (part, trajectory, origins): (&Motions, &Trajectory, &[usize]),
    ) -> bool {
        let bodies = CarriedBodies::new(part, |file| self.source.mesh(file));
        bodies.is_ok_and(|bodies| clearances.allow_reordered(&bodies, trajectory, origins))
    }
}

/// Checks that an option is a number from 0 on.
pub(crate) fn at_least_0(name: &str, value: f64) -> PyResult<()> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("{name} is {value}; at least 0 is needed")))
}
