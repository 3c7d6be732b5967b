//! Commands that search for faster programs (feature `optimise`).

mod advise;
mod optimise;
mod order;
mod place;
mod searched_program;

use crate::{args::SearchCommand, failure::Failure};

use searched_program::{PathRule, SearchedProgram};

pub(crate) fn run(command: SearchCommand) -> Result<(), Failure> {
    match command {
        SearchCommand::Advise(options) => advise::run(&options),
        SearchCommand::Optimise(options) => optimise::run(&options),
        SearchCommand::Order(options) => order::run(&options),
        SearchCommand::Place(options) => place::run(&options),
    }
}
