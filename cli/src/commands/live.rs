//! Commands for a robot behind a drive, and for the drive and the simulated cabinet themselves
//! (feature `live`).

mod cabinet;
mod drive;
mod experiment;
mod io;
mod keygen;
mod record;
mod run;
mod sensors;
mod status;
mod stop;
mod twin;

use crate::{args::Live, failure::Failure};

pub(crate) fn run(command: Live) -> Result<(), Failure> {
    match command {
        Live::Run(options) => run::run(&options),
        Live::Experiment(options) => experiment::run(&options),
        Live::Twin(options) => twin::run(&options),
        Live::Record(options) => record::run(&options),
        Live::Status(options) => status::run(&options),
        Live::Stop(options) => stop::run(&options),
        Live::Io(options) => io::run(&options.action),
        Live::Sensors(options) => sensors::run(&options),
        Live::Drive(options) => drive::run(&options),
        Live::Cabinet(options) => cabinet::run(&options),
        Live::Keygen(options) => keygen::run(&options),
    }
}
