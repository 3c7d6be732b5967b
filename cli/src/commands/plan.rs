//! `iiwasim plan`.

mod answer;
mod many;
mod one;
mod programs;
mod tables;
mod target;
mod work;

use crate::{args::Plan, failure::Failure};

/// Plans programs, writes their trajectories and prints their figures.
pub(crate) fn run(options: &Plan) -> Result<(), Failure> {
    if options.min_clearance.is_some() && options.scene.is_none() {
        return Err(Failure::input("--min-clearance needs a scene: --scene SCENE.json"));
    }
    match options.programs.as_slice() {
        [folder] if options.answering.is_given() => one::run(options, folder),
        _ if options.answering.is_given() => Err(Failure::input(
            "--application and answers are for one Sunrise project, which is named by its folder",
        )),
        [program] if target::is_stdin(program) || !program.is_dir() => one::run(options, program),
        given => many::run(options, given),
    }
}
