//! Prints what paths of the TCP cost to plan, how this grows, and how much sooner the arm gets there than by one trapezoid, as
//! Markdown tables. With `--long`: longer programs, and more LINs.
//!
//! It fails where something cannot be planned, or where the arm's advantage is lost; times never count.

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
