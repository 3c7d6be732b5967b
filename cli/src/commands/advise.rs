//! `iiwasim advise`.

use std::collections::BTreeMap;

use iiwa_files::interrupt;
use iiwa_optimise::{Advice, Adviser};
use iiwa_plan::{Error, Plan};
use iiwa_program::{MotionIndex, Program};
use iiwa_report::{AdviceReport, carried};
use iiwa_scene::ArmInScene;
use iiwa_traj::{PlanError, SweepOptions, Trajectory};

use crate::{
    application::program_or_application,
    args::{Advise, ChosenRows},
    failure::{Failure, print_note},
    input::{self, Input},
    output,
    output_kind::OutputKind,
    terminal,
};

/// Prints the changes that save time, and writes the program with some of them.
pub(crate) fn run(options: &Advise) -> Result<(), Failure> {
    let robot = options.robot.as_deref();
    let mut input = program_or_application(&options.program, &options.answering, robot)?;
    input.request.options.timing = options.timing.with(SweepOptions::default());
    if let Some(path) = &options.output {
        output::keep_existing(OutputKind::Program, path, options.overwrite)?;
    }
    // Plans the program as it is: its errors name places in its text.
    let plan = input.request.plan_with(&mut None, &input.source, &interrupt::flag());
    let plan = plan.map_err(|error| input.to_failure(&error))?;
    let adviser = Adviser::new(plan.robot().clone(), input.request.options)
        .with_max_blend_mm(options.max_blend_mm)
        .interrupted_by(interrupt::flag());
    let Some(scene) = &options.scene else {
        let advice = adviser.advise(&plan.program);
        return finish(options, &input, &adviser, advice, &|_| true);
    };
    let scene = input::scene(scene)?;
    let shapes = carried(&input.source).map_err(|error| input.to_failure(&error))?;
    let arm = ArmInScene::new(plan.robot(), &scene).carrying(&shapes);
    let clearances = AllowedClearances::new(&arm, &plan, 1e-3 * options.min_clearance)?;
    let rule = |trajectory: &Trajectory| clearances.allow(trajectory);
    let advice = adviser.advise_within(&plan.program, &rule);
    finish(options, &input, &adviser, advice, &rule)
}

/// Prints the advice, and writes the program with the chosen changes.
fn finish(
    options: &Advise,
    input: &Input,
    adviser: &Adviser,
    advice: Result<Advice, PlanError>,
    rule: &dyn Fn(&Trajectory) -> bool,
) -> Result<(), Failure> {
    let Input { source, .. } = input;
    let to_failure = |error| {
        input.to_failure(&Error::plan(error, &source.program.sources, source.text.as_read()))
    };
    let advice = advice.map_err(to_failure)?;
    let report = AdviceReport::new(&advice, &source.program, options.scene.is_some());
    if options.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.text(terminal::width()))?;
    }
    let (Some(rows), Some(path)) = (&options.apply, &options.output) else { return Ok(()) };
    let changed = applied(rows, &advice, &source.program)?;
    // Each row was planned alone, and after all rows before it: some of them together may differ.
    let trajectory = adviser.plan(&changed).map_err(|error| {
        Failure::input(format!("the changes of --apply cannot be planned together: {error}"))
    })?;
    if !rule(&trajectory) {
        return Err(Failure::input(
            "the changes of --apply together bring the arm too near to an obstacle or to itself",
        ));
    }
    output::write(path, format!("{}\n", changed.to_json()).as_bytes())?;
    let seconds = trajectory.cycle_time_s();
    print_note(&format!("Note: {} has a cycle time of {seconds:.3} s\n", path.display()));
    Ok(())
}

/// Returns the program with the changes of some rows.
fn applied(rows: &ChosenRows, advice: &Advice, program: &Program) -> Result<Program, Failure> {
    let numbers = match rows {
        ChosenRows::All => return Ok(advice.program.clone()),
        ChosenRows::Numbers(numbers) => numbers,
    };
    numbers.iter().try_fold(program.clone(), |program, number| {
        let row = number.checked_sub(1).and_then(|index| advice.rows.get(index));
        let changed = row.and_then(|row| row.change.apply(&program));
        changed.ok_or_else(|| {
            let rows = advice.rows.len();
            Failure::input(format!("--apply: there are {rows} rows, and no row {number}"))
        })
    })
}

/// Clearances from obstacles and of the arm from itself that a changed program has to keep.
struct AllowedClearances<'a> {
    arm: &'a ArmInScene,
    min_m: f64,
    /// Smallest clearance of each motion of the unchanged program, in m.
    motions_m: BTreeMap<MotionIndex, f64>,
    itself_m: f64,
}

impl<'a> AllowedClearances<'a> {
    /// Accuracy of clearances, in m.
    const ACCURACY_M: f64 = 1e-4;

    /// Measures the unchanged program, which must not touch anything.
    fn new(arm: &'a ArmInScene, plan: &Plan, min_m: f64) -> Result<Self, Failure> {
        let trajectory = &plan.trajectory;
        if let Some(nearest) = arm.clearance_of(trajectory)
            && nearest.clearance.distance_m <= 0.0
        {
            return Err(Failure::input(format!(
                "the arm touches {} in {}: changes can be checked only for a program that touches \
                 no obstacle",
                arm.name_of(nearest.clearance.other),
                plan.program.sources.in_message(&format!("motion {}", nearest.motion)),
            )));
        }
        let motions_m = clearances_m(arm, trajectory);
        Ok(Self { arm, min_m, motions_m, itself_m: itself_m(arm, trajectory) })
    }

    /// Returns true if each motion, and the arm as a whole, keeps the smallest clearance, or its
    /// own one before the change if that is less.
    fn allow(&self, trajectory: &Trajectory) -> bool {
        let least_m = |before_m: f64| self.min_m.min(before_m) - Self::ACCURACY_M;
        itself_m(self.arm, trajectory) >= least_m(self.itself_m)
            && clearances_m(self.arm, trajectory).into_iter().all(|(motion, clearance_m)| {
                let before_m = self.motions_m.get(&motion).copied().unwrap_or(f64::INFINITY);
                clearance_m >= least_m(before_m)
            })
    }
}

/// Smallest distance of each motion from the obstacles, in m.
fn clearances_m(arm: &ArmInScene, trajectory: &Trajectory) -> BTreeMap<MotionIndex, f64> {
    let mut motions_m = BTreeMap::new();
    let planned = trajectory.sections().iter().flat_map(|section| arm.clearances(section));
    for nearest in planned {
        let least_m = motions_m.entry(nearest.motion).or_insert(f64::INFINITY);
        *least_m = nearest.clearance.distance_m.min(*least_m);
    }
    motions_m
}

/// Smallest distance of the arm from itself, in m.
fn itself_m(arm: &ArmInScene, trajectory: &Trajectory) -> f64 {
    arm.self_clearance_of(trajectory).map_or(f64::INFINITY, |nearest| nearest.clearance.distance_m)
}
