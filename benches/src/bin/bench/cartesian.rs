//! Prints what paths of the TCP cost to plan, how this grows, and how much sooner the arm gets there than by one trapezoid, as
//! Markdown tables. With `--long`: longer programs, and more LINs.
//!
//! It fails where something cannot be planned, or where the arm's advantage is lost; times never count.
#![expect(clippy::print_stdout, reason = "tables are what it is for")]

mod clock;
mod growth;
mod mixed;
mod rival;
mod single;
mod straight;
mod trapezoid;
mod versus;

use std::{env, process::ExitCode};

use iiwasim_benches::{Result, machine};

fn main() -> Result<ExitCode> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let is_long = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
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
