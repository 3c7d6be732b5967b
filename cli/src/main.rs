//! `iiwasim`: which path will the arm take through a motion program, and how long will it take?
//!
//! Results go to standard output, everything else to standard error. This file alone decides on the
//! exit code: 0 done; 1 it failed while running; 2 wrong usage or invalid input; 3 done, but a gate
//! was not met, or of many programs some failed.

mod args;
mod arm_files;
mod broker_access;
mod commands;
mod connection;
mod failure;
mod file_kind;
mod frame;
mod input;
mod lines;
mod log;
mod output;
mod picture;
mod progress;
mod replaceable;
mod runner;
mod settings;
mod sunrise;
mod twin_failure;

use std::process::ExitCode;

use args::{Arguments, Command};
use failure::{Failure, print_note};
use settings::Settings;

fn main() -> ExitCode {
    let result = Settings::read().map_or_else(
        |failure| {
            // Help is given whatever the settings are.
            Arguments::read(&Settings::default());
            Err(failure)
        },
        |settings| {
            let arguments = Arguments::read(&settings);
            if let Some(robot) = settings.into_robot() {
                input::set_default_robot(robot);
            }
            run(arguments.command)
        },
    );
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            print_note(&failure.text());
            ExitCode::from(match failure {
                Failure::Run { .. } => 1,
                Failure::Input(_) => 2,
                Failure::Gate(_) => 3,
            })
        }
    }
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Plan(options) => commands::plan::run(&options),
        Command::Experiment(options) => commands::experiment::run(&options),
        Command::Compare(options) => commands::compare::run(&options),
        Command::Report(options) => commands::report::run(&options),
        Command::Identify(options) => commands::identify::run(&options),
        Command::Fk(options) => commands::fk::run(&options),
        Command::Ik(options) => commands::ik::run(&options),
        Command::Import(options) => commands::import::run(&options),
        Command::Export(options) => commands::export::run(&options),
        Command::Robot(options) => commands::robot::run(&options),
        Command::Schema(options) => commands::schema::run(&options),
        Command::Keygen(options) => commands::keygen::run(&options),
        Command::Drive(options) => commands::drive::run(&options),
        Command::Cabinet(options) => commands::cabinet::run(&options),
        Command::Run(options) => commands::run::run(&options),
        Command::Record(options) => commands::record::run(&options),
        Command::Bridge(options) => commands::bridge::run(&options),
        Command::Replay(options) => commands::replay::run(&options),
        Command::History(options) => commands::history::run(&options),
        Command::Status(options) => commands::status::run(&options),
        Command::Twin(options) => commands::twin::run(&options),
        Command::Stop(options) => commands::stop::run(&options),
        Command::Io(options) => commands::io::run(&options.action),
        Command::Sensors(options) => commands::sensors::run(&options),
        Command::Completions(options) => commands::completions::run(&options),
        Command::Man(options) => commands::man::run(&options),
    }
}
