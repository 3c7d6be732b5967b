//! Prints the planning time of TCP paths, its growth, and the reduction of motion time compared
//! with a single trapezoid, as Markdown tables. With `--long`: longer programs, and more LINs.
//!
//! The bench fails if planning fails, or if the reduction of motion time is lost; planning times
//! never cause a failure.

mod clock;
mod growth;
mod mixed;
mod rival;
mod single;
mod straight;
mod trapezoid;
mod versus;

use std::process::ExitCode;

use iiwasim_benches::{Result, machine};

pub(crate) fn run(arguments: &[&str]) -> Result<ExitCode> {
    let is_long = match arguments {
        [] => false,
        ["--long"] => true,
        _ => return Err("it takes no arguments but --long".into()),
    };
    println!("On {}, {}.\n", machine::processor(), machine::instruction_level());
    single::print()?;
    println!();
    mixed::print()?;
    println!();
    let lengths: &[usize] = if is_long { &[10, 100, 1000, 10_000] } else { &[10, 100, 1000] };
    growth::print(lengths)?;
    println!();
    let is_ahead = versus::print(if is_long { 1000 } else { 300 })?;
    Ok(if is_ahead { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
