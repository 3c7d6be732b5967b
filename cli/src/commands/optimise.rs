//! `iiwasim optimise`.

use std::path::Path;

use iiwa_eval::PlanVersion;
use iiwa_optimise::{Freedom, Optimum};
use iiwa_plan::Plan;
use iiwa_program::Program;
use iiwa_report::{DifferenceReport, OptimumReport};

use crate::{
    args::Optimise,
    failure::{Failure, print_note},
    input::Input,
    output,
    output_kind::OutputKind,
    search::Search,
    terminal,
};

/// Writes the fastest version of a program that the search finds, and prints what changes.
pub(crate) fn run(options: &Optimise) -> Result<(), Failure> {
    keep_existing(options)?;
    Search::with(&options.search, |search| finish(options, search))
}

fn finish(options: &Optimise, mut search: Search<'_>) -> Result<(), Failure> {
    let program = &search.plan.program;
    search.optimiser = search.optimiser.with_freedom(options.freedom()).with_budget(options.budget);
    let optimiser = &search.optimiser;
    let optimum = search.run(|| match search.rule {
        Some(rule) => optimiser.optimise_within(program, rule),
        None => optimiser.optimise(program),
    })?;
    let (changed, plan) = planned_again(&search, &optimum)?;
    let differences = DifferenceReport::new(&search.plan.into(), &PlanVersion::from(&plan));
    let report = OptimumReport::new(&optimum, program, search.rule.is_some(), differences);
    write(options, &changed)?;
    if options.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.text(terminal::width()))?;
    }
    if options.freedom() == Freedom::ELBOWS && optimum.changes.is_empty() {
        print_note("Note: --free e1,blends,speeds allows changes of other kinds\n");
    }
    Ok(())
}

/// Plans the changed program from its text, as it is written.
fn planned_again(search: &Search<'_>, optimum: &Optimum) -> Result<(Input, Plan), Failure> {
    const TOLERANCE_S: f64 = 1e-6;

    let Search { input, plan, .. } = search;
    let wrong = |what: &str| {
        Failure::input(format!("{}: the changed program {what}; nothing is written", input.name))
    };
    let program = Program::from_json(&optimum.program.to_json())
        .map_err(|error| wrong(&format!("cannot be read again: {error}")))?;
    let mut changed = Input::generated(input.name.clone(), program, plan.robot().clone());
    changed.request.options = input.request.options;
    let planned = changed.plan()?;
    let cycle_time_s = planned.trajectory.cycle_time_s();
    if (cycle_time_s - optimum.changed_cycle_time_s).abs() > TOLERANCE_S {
        return Err(wrong(&format!("takes {cycle_time_s:.6} s when it is planned again")));
    }
    if !search.allows(&planned.trajectory) {
        return Err(wrong("comes too near to an obstacle when it is planned again"));
    }
    Ok((changed, planned))
}

/// Returns true for a program in JSON; any other output is the folder of a project.
fn is_program(output: &Path) -> bool {
    output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

/// Rejects outputs that exist, unless they are to be replaced.
fn keep_existing(options: &Optimise) -> Result<(), Failure> {
    let output = options.output.as_path();
    if is_program(output) {
        return output::keep_existing(OutputKind::Program, output, options.overwrite);
    }
    #[cfg(feature = "sunrise")]
    return super::sunrise::export::keep_existing(output, options.overwrite);
    #[cfg(not(feature = "sunrise"))]
    Err(crate::features::SUNRISE.missing("a Sunrise project"))
}

/// Writes the changed program as JSON, or as a Sunrise project.
fn write(options: &Optimise, changed: &Input) -> Result<(), Failure> {
    let output = options.output.as_path();
    if is_program(output) {
        let text = format!("{}\n", changed.source.program.to_json());
        return output::write(output, text.as_bytes());
    }
    #[cfg(feature = "sunrise")]
    {
        let name = output.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let how = iiwa_sunrise::ExportOptions { name, class: None };
        let robot = changed.robot()?;
        let project = super::sunrise::export::write_project(changed, &robot, &how, output)?;
        let start_deg = project.start_deg.map(|deg| deg.to_string()).join(",");
        print_note(&format!(
            "Note: {}: the application {}; the arm must be at {start_deg} deg before it runs\n",
            output.display(),
            project.class
        ));
        for notice in &project.notices {
            print_note(&format!("Note: {}\n", iiwa_json::printable(&notice.to_string())));
        }
    }
    Ok(())
}
