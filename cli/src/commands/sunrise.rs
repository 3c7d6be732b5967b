//! Commands for Sunrise projects (feature `sunrise`).

pub(crate) mod export;
mod import;

use crate::{args::Sunrise, failure::Failure};

pub(crate) fn run(command: Sunrise) -> Result<(), Failure> {
    match command {
        Sunrise::Import(options) => import::run(&options),
        Sunrise::Export(options) => export::run(&options),
    }
}
