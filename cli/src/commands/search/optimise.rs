//! `iiwasim optimise`.

use std::path::Path;

use iiwa_eval::PlanVersion;
use iiwa_files::{Output, interrupt};
use iiwa_optimise::{Freedom, Optimum};
use iiwa_page::{Page, PageOptions, pair_page};
use iiwa_report::{DifferenceReport, OptimumReport};

use super::SearchedProgram;
use crate::{
    args::Optimise,
    failure::{Failure, print_note},
    input::Input,
    output,
    output_kind::OutputKind,
    terminal,
};

/// Writes the fastest version of a program that the search finds, and prints the changes.
pub(crate) fn run(options: &Optimise) -> Result<(), Failure> {
    keep_existing(options)?;
    SearchedProgram::with(&options.search, |search| finish(options, search))
}

fn finish(options: &Optimise, mut search: SearchedProgram<'_>) -> Result<(), Failure> {
    let program = &search.plan.program;
    // A program that cannot be exported is an error before the search.
    #[cfg(feature = "sunrise")]
    if !is_program(&options.output) {
        crate::commands::sunrise::export::check(search.input, search.plan.robot())?;
    }
    search.optimiser = search.optimiser.with_freedom(options.freedom()).with_budget(options.budget);
    let optimiser = &search.optimiser;
    let optimum = search.run(|| match search.rule {
        Some(rule) => optimiser.optimise_within(program, rule),
        None => optimiser.optimise(program),
    })?;
    let beside =
        if is_program(&options.output) { &options.output } else { &options.search.input.program };
    let Optimum { program: changed, changed_cycle_time_s, .. } = &optimum;
    let (changed, plan) = search.planned_again(changed, *changed_cycle_time_s, beside)?;
    let differences = DifferenceReport::new(&search.plan.into(), &PlanVersion::from(&plan));
    let report = OptimumReport::new(&optimum, program, search.rule.is_some(), differences);
    // Before the program is written: a page may fail.
    let html = options.page.as_ref().map(|_| page(&search, &changed, &report)).transpose()?;
    write(options, &changed)?;
    if let (Some(path), Some(html)) = (&options.page, html) {
        output::write(path, html.as_bytes())?;
    }
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

/// Returns true for a program in JSON; any other output is the folder of a project.
fn is_program(output: &Path) -> bool {
    output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

/// Rejects outputs that exist, unless they are to be replaced, and those among the inputs.
fn keep_existing(options: &Optimise) -> Result<(), Failure> {
    let output = options.output.as_path();
    let search = &options.search;
    let scene = search.around.scene.as_deref().map(|path| ("scene", path));
    let inputs = [("program", search.input.program.as_path())].into_iter().chain(scene);
    if let Some(page) = &options.page {
        let others = inputs.clone().chain([("changed program", output)]);
        output::keep_others(OutputKind::Page, page, others, "--page")?;
        OutputKind::Page.check_existing(page)?;
        if !page.exists() {
            // Reports an output that cannot be written before the search.
            Output::new(page).map(drop)?;
        }
    }
    if is_program(output) {
        output::keep_others(OutputKind::Program, output, inputs, "--output")?;
        return output::keep_existing(OutputKind::Program, output, options.overwrite);
    }
    #[cfg(feature = "sunrise")]
    {
        let full = |path: &Path| std::fs::canonicalize(path).ok();
        // The folder need not exist yet.
        let folder = full(output).or_else(|| output.parent().and_then(full));
        if let (Some(project), Some(folder)) = (full(&search.input.program), folder)
            && project.is_dir()
            && (folder.starts_with(&project) || output.exists() && project.starts_with(&folder))
        {
            return Err(Failure::input(format!(
                "{} and the project that is read lie in each other; name another folder with \
                 --output",
                output.display()
            )));
        }
        crate::commands::sunrise::export::keep_existing(output, options.overwrite)
    }
    #[cfg(not(feature = "sunrise"))]
    Err(crate::features::SUNRISE.missing("a Sunrise project"))
}

/// Returns the page with the plans before and after the changes.
fn page(
    search: &SearchedProgram<'_>,
    changed: &Input,
    report: &OptimumReport,
) -> Result<String, Failure> {
    let scene = search.scene.cloned();
    let how = PageOptions { scene, interrupted: interrupt::has_come, ..PageOptions::default() };
    let plan = |title: &str, Input { source, request, .. }: &Input| {
        Page::of_program(title, source, request, &how)
    };
    let title = Path::new(&search.input.name).file_name().unwrap_or_default().to_string_lossy();
    let plans = [plan("before", search.input)?, plan("after", changed)?];
    Ok(pair_page(&title, plans.each_ref(), &report.changes())?)
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
        let project =
            crate::commands::sunrise::export::write_project(changed, &robot, &how, output)?;
        let start_deg = project.start_deg.map(|deg| deg.to_string()).join(",");
        print_note(&format!(
            "Note: {}: the application {}; the arm must be at {start_deg} deg before it runs\n",
            output.display(),
            project.class
        ));
        for notice in &project.notices {
            let notice = changed.source.program.sources.in_message(&notice.to_string());
            print_note(&format!("Note: {}\n", iiwa_json::printable(&notice)));
        }
    }
    Ok(())
}
