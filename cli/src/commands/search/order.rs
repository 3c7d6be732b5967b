//! `iiwasim order`.

use iiwa_program::Program;
use iiwa_report::OrderReport;
use iiwa_scene::CarriedBodies;
use iiwa_traj::Trajectory;

use super::SearchedProgram;
use crate::{args::OrderTasks, failure::Failure};

/// Tasks in a program.
const EXAMPLE: &str = r#""tasks": [{ "group": "left" }, { "group": "right", "after": ["left"] }]"#;

/// Prints the fastest order of the tasks, and writes the program in that order.
pub(crate) fn run(options: &OrderTasks) -> Result<(), Failure> {
    let scene = options.around.scene.as_deref().map(|path| ("scene", path));
    let inputs = [("program", options.input.program.as_path())].into_iter().chain(scene);
    options.found.check(inputs)?;
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
    let found = search.run(|| match search.clearances {
        Some(clearances) => {
            let rule = |part: &Program, trajectory: &Trajectory, origins: &[usize]| {
                let mesh = |file: &str| search.input.source.mesh(file);
                CarriedBodies::new(part, mesh)
                    .is_ok_and(|bodies| clearances.allow_reordered(&bodies, trajectory, origins))
            };
            optimiser.order_within(program, &rule)
        }
        None => optimiser.order(program),
    })?;
    let report = OrderReport::new(&found, program, search.clearances.is_some());
    let program = (&found.program, found.changed_cycle_time_s);
    search.finish(&options.found, program, &report, OrderReport::text)
}
