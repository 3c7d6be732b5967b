//! Searches for changes that make a program faster.

use std::{
    fs,
    path::Path,
    sync::{atomic::Ordering::Relaxed, mpsc},
    thread,
    time::Duration,
};

use iiwa_files::interrupt;
use iiwa_optimise::Optimiser;
use iiwa_plan::{Error, Plan, ProgramSource};
use iiwa_program::Program;
use iiwa_report::carried;
use iiwa_scene::{AllowedClearances, ArmInScene, Scene};
use iiwa_traj::{PlanError, SweepOptions, Trajectory};
use serde::Serialize;

use crate::{
    application::program_or_application,
    args::{SceneOptions, SearchInput, SearchOptions, SearchOutput},
    failure::{Failure, print_note},
    input::{self, Input},
    output,
    output_kind::OutputKind,
    progress::Progress,
    terminal,
};

impl SearchOutput {
    /// Rejects an output that exists, unless it is to be replaced, and one among the inputs.
    pub(crate) fn check<'a>(
        &self,
        inputs: impl IntoIterator<Item = (&'a str, &'a Path)>,
    ) -> Result<(), Failure> {
        let Some(path) = &self.output else { return Ok(()) };
        output::keep_others(OutputKind::Program, path, inputs, "--output")?;
        output::keep_existing(OutputKind::Program, path, self.overwrite)
    }
}

/// Rule that the trajectory of a changed program has to satisfy.
pub(crate) type PathRule<'a> = &'a (dyn Fn(&Trajectory) -> bool + Sync);

/// A program with its plan, and what a search for changes needs.
pub(crate) struct SearchedProgram<'a> {
    options: &'a SearchInput,
    pub(crate) input: &'a Input,
    pub(crate) plan: &'a Plan,
    pub(crate) optimiser: Optimiser,
    /// The scene, if there is one.
    pub(crate) scene: Option<&'a Scene>,
    /// The clearances that the unchanged program has there.
    pub(crate) clearances: Option<&'a AllowedClearances<'a>>,
    /// Accepts trajectories with such clearances.
    pub(crate) rule: Option<PathRule<'a>>,
}

impl SearchedProgram<'_> {
    /// Reads and plans the program, and calls `work`.
    pub(crate) fn read(
        options: &SearchInput,
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
            .interrupted_by(interrupt::flag());
        let (input, plan) = (&input, &plan);
        work(SearchedProgram {
            options,
            input,
            plan,
            optimiser,
            scene: None,
            clearances: None,
            rule: None,
        })
    }

    /// Reads and plans the program, measures its clearances, and calls `work`.
    pub(crate) fn with(
        options: &SearchOptions,
        work: impl FnOnce(SearchedProgram<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        SearchedProgram::read(&options.input, |mut search| {
            search.optimiser = search.optimiser.with_max_blend_mm(options.max_blend_mm);
            search.in_scene(&options.around, work)
        })
    }

    /// Measures the clearances of the program, and calls `work`.
    pub(crate) fn in_scene(
        self,
        options: &SceneOptions,
        work: impl FnOnce(SearchedProgram<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let Some(scene) = &options.scene else { return work(self) };
        let scene = input::scene(scene)?;
        let Self { input, plan, .. } = self;
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
        work(SearchedProgram {
            scene: Some(&scene),
            clearances: Some(&clearances),
            rule: Some(&rule),
            ..self
        })
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

    /// Plans a changed program from its text, as it is written to the folder of `beside`: with the
    /// robot and the files that it names. It has to take `cycle_time_s`.
    pub(crate) fn planned_again(
        &self,
        changed: &Program,
        cycle_time_s: f64,
        beside: &Path,
    ) -> Result<(Input, Plan), Failure> {
        const TOLERANCE_S: f64 = 1e-6;

        let name = &self.input.name;
        let wrong = |what: &str| {
            Failure::input(format!("{name}: the changed program {what}; nothing is written"))
        };
        let mut program = changed.clone();
        let usual = input::usual_robot().filter(|_| program.robot.is_none());
        if let Some(robot) = self.options.robot.as_deref().or(usual) {
            program.robot = Some(named(&program, robot));
        }
        let source = ProgramSource::beside(beside, &program.to_json());
        let source = source.map_err(|error| wrong(&format!("cannot be read again: {error}")))?;
        let mut request = input::request(&source, None)?;
        request.options = self.input.request.options;
        let changed = Input { name: name.clone(), source, request };
        let planned = changed.plan()?;
        let again_s = planned.trajectory.cycle_time_s();
        if (again_s - cycle_time_s).abs() > TOLERANCE_S {
            return Err(wrong(&format!("takes {again_s:.6} s when it is planned again")));
        }
        if !self.allows(&planned.trajectory) {
            return Err(wrong("brings the arm too near to an obstacle when it is planned again"));
        }
        Ok((changed, planned))
    }

    /// Writes the program that a search has found, if an output is given, and prints its report.
    pub(crate) fn finish<R: Serialize>(
        &self,
        output: &SearchOutput,
        (found, cycle_time_s): (&Program, f64),
        report: &R,
        text: impl FnOnce(&R, Option<u16>) -> String,
    ) -> Result<(), Failure> {
        if let Some(path) = &output.output {
            let (again, _) = self.planned_again(found, cycle_time_s, path)?;
            output::write(path, format!("{}\n", again.source.program.to_json()).as_bytes())?;
            if *found == *self.plan.program {
                print_note(&format!("Note: {} is the unchanged program\n", path.display()));
            }
        }
        if output.json {
            output::print_json(report)
        } else {
            output::print(&text(report, terminal::width()))
        }
    }

    /// Returns true if a trajectory keeps the clearances.
    pub(crate) fn allows(&self, trajectory: &Trajectory) -> bool {
        self.rule.is_none_or(|rule| rule(trajectory))
    }
}

/// Name of a robot in a program: the robot of a file by its full path, since the program may be
/// written to another folder.
fn named(program: &Program, robot: &str) -> String {
    match program.robot.as_deref() {
        Some(own) if own == robot => own.to_owned(),
        _ => fs::canonicalize(robot)
            .map_or_else(|_| robot.to_owned(), |path| path.display().to_string()),
    }
}
