//! `iiwasim advise`.

use iiwa_optimise::{Advice, Freedom};
use iiwa_program::Program;
use iiwa_report::AdviceReport;

use super::SearchedProgram;
use crate::{
    args::{Advise, ChosenRows},
    failure::{Failure, print_note},
    output,
    output_kind::OutputKind,
    terminal,
};

/// Prints the changes that save time, and writes the program with some of them.
pub(crate) fn run(options: &Advise) -> Result<(), Failure> {
    if let Some(path) = &options.output {
        output::keep_existing(OutputKind::Program, path, options.overwrite)?;
    }
    SearchedProgram::with(&options.search, |mut search| {
        search.optimiser = search.optimiser.with_freedom(Freedom::ALL);
        finish(options, &search)
    })
}

/// Prints the advice, and writes the program with the chosen changes.
fn finish(options: &Advise, search: &SearchedProgram<'_>) -> Result<(), Failure> {
    let (optimiser, program) = (&search.optimiser, &search.plan.program);
    let advice = search.run(|| match search.rule {
        Some(rule) => optimiser.advise_within(program, rule),
        None => optimiser.advise(program),
    })?;
    let report = AdviceReport::new(&advice, program, search.rule.is_some());
    if options.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.text(terminal::width()))?;
    }
    let (Some(rows), Some(path)) = (&options.apply, &options.output) else { return Ok(()) };
    let changed = applied(rows, &advice, program)?;
    // Each row was planned alone, and after all rows before it: some of them together may differ.
    let trajectory = optimiser.plan(&changed).map_err(|error| {
        Failure::input(format!("the changes of --apply cannot be planned together: {error}"))
    })?;
    if !search.allows(&trajectory) {
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
