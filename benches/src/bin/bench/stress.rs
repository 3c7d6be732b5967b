//! Plans random programs of several families with jerk limits and with acceleration limits, and
//! counts failures: programs without a solution, limits exceeded at any instant, stamps that do not
//! increase, impossible times.
//!
//! ```text
//! bench stress [PROGRAMS [SEED]] [--family NAME]       100 000 programs by default, which
//!                                                      alternate between the families
//! bench stress [SEED] --family NAME --program NUMBER   one of them: a table of its pieces
//! bench stress --file PROGRAM.json                     the same of any program
//! ```
//!
//! With `--json`, one program is printed and not planned. Exits with 1 if a plan is wrong. A
//! program that is rejected, with an error, is counted separately.

mod arguments;

mod table;
mod tally;

use std::{process::ExitCode, time::Instant};

use iiwasim_benches::{Result, machine};
use iiwasim_tests::{families::Family, plan_check::PlanCheck};

use self::{arguments::Task, table::print_table, tally::Tally};

pub(crate) fn run(arguments: &[&str]) -> Result<ExitCode> {
    let passed = match Task::read(arguments)? {
        Task::Json(program) => {
            println!("{}", program.to_json());
            true
        }
        Task::Table(program) => {
            print_table(&program)?;
            let PlanCheck { refusals, failures, .. } = PlanCheck::of(&program);
            for message in refusals.iter().chain(&failures) {
                println!("{message}");
            }
            failures.is_empty()
        }
        Task::Run { family, seed, programs } => judge(family, seed, programs),
    };
    Ok(if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Judges programs of one family, or of all in turn; returns true without failures.
fn judge(family: Option<Family>, seed: u64, programs: u64) -> bool {
    println!("On {}, {}.", machine::processor(), machine::instruction_level());
    let families = family.map_or_else(|| Family::ALL.to_vec(), |family| vec![family]);
    let mut tallies: Vec<Tally> = families.iter().copied().map(Tally::new).collect();
    let start = Instant::now();
    let mut said_s = 0.0;
    for number in 0..programs {
        let turn = number / tallies.len() as u64;
        // The next family in turn has judged the fewest programs.
        if let Some(tally) = tallies.iter_mut().find(|tally| tally.programs() == turn) {
            tally.add(seed, turn);
        }
        let seconds = start.elapsed().as_secs_f64();
        if seconds > said_s + 60.0 && number + 1 < programs {
            said_s = seconds;
            let failed: usize = tallies.iter().map(Tally::failed).sum();
            println!("{} programs, {seconds:.0} s: {failed} failed", number + 1);
        }
    }
    for tally in &tallies {
        println!("\n{tally}");
    }
    let failed: usize = tallies.iter().map(Tally::failed).sum();
    let refused: usize = tallies.iter().map(Tally::refused).sum();
    let seconds = start.elapsed().as_secs_f64();
    println!("\n{programs} programs, {seconds:.0} s: {failed} failed, {refused} refused");
    failed == 0
}
