//! Searches for changes that make a program faster.

use std::{
    sync::{atomic::Ordering::Relaxed, mpsc},
    thread,
    time::Duration,
};

use iiwa_files::interrupt;
use iiwa_optimise::Optimiser;
use iiwa_plan::{Error, Plan};
use iiwa_report::carried;
use iiwa_scene::{AllowedClearances, ArmInScene, Scene};
use iiwa_traj::{PlanError, SweepOptions, Trajectory};

use crate::{
    application::program_or_application,
    args::SearchOptions,
    failure::Failure,
    input::{self, Input},
    output,
    progress::Progress,
};

/// Rule that the trajectory of a changed program has to satisfy.
pub(crate) type PathRule<'a> = &'a (dyn Fn(&Trajectory) -> bool + Sync);

/// A program with its plan, and what a search for changes needs.
pub(crate) struct SearchedProgram<'a> {
    pub(crate) input: &'a Input,
    pub(crate) plan: &'a Plan,
    pub(crate) optimiser: Optimiser,
    pub(crate) scene: Option<&'a Scene>,
    /// The clearances in the scene, if there is one.
    pub(crate) rule: Option<PathRule<'a>>,
}

impl SearchedProgram<'_> {
    /// Reads and plans the program, measures its clearances, and calls `work`.
    pub(crate) fn with(
        options: &SearchOptions,
        work: impl FnOnce(SearchedProgram<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let robot = options.robot.as_deref();
        let mut input = program_or_application(&options.program, &options.answering, robot)?;
        // Not before a program is read from a terminal.
        output::catch_interrupts();
        input.request.options.timing = options.timing.with(SweepOptions::default());
        // Plans the program as it is: its errors name places in its text.
        let plan = input.request.plan_with(&mut None, &input.source, &interrupt::flag());
        let plan = plan.map_err(|error| input.to_failure(&error))?;
        let optimiser = Optimiser::new(plan.robot().clone(), input.request.options)
            .with_max_blend_mm(options.max_blend_mm)
            .interrupted_by(interrupt::flag());
        let search =
            SearchedProgram { input: &input, plan: &plan, optimiser, scene: None, rule: None };
        let Some(scene) = &options.scene else { return work(search) };
        let scene = input::scene(scene)?;
        let shapes = carried(&input.source).map_err(|error| input.to_failure(&error))?;
        let arm = ArmInScene::new(plan.robot(), &scene).carrying(&shapes);
        let min_m = 1e-3 * options.min_clearance;
        let clearances =
            AllowedClearances::new(&arm, &plan.trajectory, min_m).map_err(|contact| {
                Failure::input(format!(
                    "the arm touches {} in {}: changes can be checked only for a program that \
                     touches no obstacle",
                    arm.name_of(contact.clearance.other),
                    plan.program.sources.in_message(&format!("motion {}", contact.motion)),
                ))
            })?;
        let rule = |trajectory: &Trajectory| clearances.allow(trajectory);
        work(SearchedProgram { scene: Some(&scene), rule: Some(&rule), ..search })
    }

    /// Runs a search with its progress.
    pub(crate) fn run<T: Send>(
        &self,
        search: impl FnOnce() -> Result<T, PlanError> + Send,
    ) -> Result<T, Failure> {
        const REFRESH: Duration = Duration::from_millis(100);

        let mut progress = Progress::of_search();
        let plans = self.optimiser.plan_count();
        let (sender, receiver) = mpsc::channel();
        let found = thread::scope(|scope| {
            scope.spawn(move || sender.send(search()));
            loop {
                match receiver.recv_timeout(REFRESH) {
                    Err(mpsc::RecvTimeoutError::Timeout) => progress.show(plans.load(Relaxed)),
                    found => break found,
                }
            }
        });
        progress.clear();
        // The search ends without a result only by a panic, which the scope has raised again.
        let found = found.map_err(|_| Failure::input("the search ended without a result"))?;
        let Input { source, .. } = self.input;
        found.map_err(|error| {
            let error = Error::plan(error, &source.program.sources, source.text.as_read());
            self.input.to_failure(&error)
        })
    }

    /// Returns true if a trajectory keeps the clearances.
    pub(crate) fn allows(&self, trajectory: &Trajectory) -> bool {
        self.rule.is_none_or(|rule| rule(trajectory))
    }
}
