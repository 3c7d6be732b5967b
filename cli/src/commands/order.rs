//! `iiwasim order`.

use iiwa_program::Program;
use iiwa_report::OrderReport;
use iiwa_scene::{ArmInScene, CarriedBodies};
use iiwa_traj::Trajectory;

use crate::{
    args::OrderTasks,
    failure::{Failure, print_note},
    output,
    output_kind::OutputKind,
    search::SearchedProgram,
    terminal,
};

/// Tasks in a program.
const EXAMPLE: &str = r#""tasks": [{ "group": "left" }, { "group": "right", "after": ["left"] }]"#;

/// Prints the fastest order of the tasks, and writes the program in that order.
pub(crate) fn run(options: &OrderTasks) -> Result<(), Failure> {
    if let Some(path) = &options.output {
        let scene = options.around.scene.as_deref().map(|path| ("scene", path));
        let inputs = [("program", options.input.program.as_path())].into_iter().chain(scene);
        output::keep_others(OutputKind::Program, path, inputs, "--output")?;
        output::keep_existing(OutputKind::Program, path, options.overwrite)?;
    }
    SearchedProgram::read(&options.input, |search| {
        if search.plan.program.sources.tasks().is_empty() {
            return Err(Failure::input(format!(
                "{}: the program lists no `tasks`, groups of motions that may be executed in \
                 another order; for example: {EXAMPLE}",
                search.input.name
            )));
        }
        search.in_scene(&options.around, |search| finish(options, search))
    })
}

fn finish(options: &OrderTasks, mut search: SearchedProgram<'_>) -> Result<(), Failure> {
    // Its clearances are those of motions in the unchanged order.
    search.rule = None;
    let (optimiser, program) = (&search.optimiser, &search.plan.program);
    let found = search.run(|| match search.clearances.zip(search.scene) {
        Some((clearances, scene)) => {
            let arm = ArmInScene::new(search.plan.robot(), scene);
            let rule = |part: &Program, trajectory: &Trajectory, origins: &[usize]| {
                let mesh = |file: &str| search.input.source.mesh(file);
                CarriedBodies::new(part, mesh).is_ok_and(|bodies| {
                    clearances.allow_reordered(&arm.carrying(&bodies), trajectory, origins)
                })
            };
            optimiser.order_within(program, &rule)
        }
        None => optimiser.order(program),
    })?;
    let report = OrderReport::new(&found, program, search.clearances.is_some());
    if let Some(path) = &options.output {
        let (ordered, _) =
            search.planned_again(&found.program, found.changed_cycle_time_s, path)?;
        output::write(path, format!("{}\n", ordered.source.program.to_json()).as_bytes())?;
        if !report.is_changed() {
            print_note(&format!("Note: {} is the unchanged program\n", path.display()));
        }
    }
    if options.json {
        output::print_json(&report)
    } else {
        output::print(&report.text(terminal::width()))
    }
}
