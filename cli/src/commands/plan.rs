//! `iiwasim plan`.

mod answer;
mod many;
mod one;
mod programs;
mod target;
mod work;

use crate::{args::Plan, failure::Failure};

/// Plans programs, writes their trajectories and prints their figures.
pub(crate) fn run(options: &Plan) -> Result<(), Failure> {
    match options.programs.as_slice() {
        [program] if target::is_stdin(program) || !program.is_dir() => one::run(options, program),
        given => many::run(options, given),
    }
}
