//! Commands that search for faster programs (feature `optimise`).

mod advise;
mod optimise;
mod order;
mod place;
mod searched_program;

use crate::{args::Search, failure::Failure};

use searched_program::{PathRule, SearchedProgram};

pub(crate) fn run(command: Search) -> Result<(), Failure> {
    match command {
        Search::Advise(options) => advise::run(&options),
        Search::Optimise(options) => optimise::run(&options),
        Search::Order(options) => order::run(&options),
        Search::Place(options) => place::run(&options),
    }
}
