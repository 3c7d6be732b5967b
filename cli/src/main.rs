//! `iiwasim`: computes the path of the arm through a motion program, and its cycle time.
//!
//! Results go to standard output, everything else to standard error. Only this file sets the exit
//! code: 0 success; 1 failure at run time; 2 wrong usage or invalid input; 3 success, but a gate
//! was violated, or some programs of several failed.

mod application;
mod args;
mod arm_files;
#[cfg(feature = "bridge")]
mod broker_access;
mod commands;
#[cfg(feature = "live")]
mod connection;
mod failure;
mod features;
mod file_kind;
mod frame;
mod input;
mod lines;
mod output;
mod output_kind;
mod picture;
mod progress;
#[cfg(feature = "live")]
mod runner;
#[cfg(feature = "live")]
mod service_log;
mod settings;
#[cfg(feature = "sunrise")]
mod sunrise;
mod terminal;
mod trace;
#[cfg(feature = "live")]
mod twin_failure;

use std::process::ExitCode;

use args::{Arguments, CliCommand};
use failure::{Failure, print_note};
use settings::SettingsFile;

fn main() -> ExitCode {
    let result = SettingsFile::read().map_or_else(
        |failure| {
            // Help must work with invalid settings.
            Arguments::read(&SettingsFile::default());
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

fn run(command: CliCommand) -> Result<(), Failure> {
    match command {
        CliCommand::Plan(options) => commands::plan::run(&options),
        CliCommand::Compare(options) => commands::compare::run(&options),
        CliCommand::Diff(options) => commands::diff::run(&options),
        #[cfg(feature = "optimise")]
        CliCommand::Search(command) => commands::search::run(command),
        CliCommand::Validate(options) => commands::validate::run(&options),
        CliCommand::Report(options) => commands::report::run(&options),
        CliCommand::Identify(options) => commands::identify::run(&options),
        #[cfg(feature = "live")]
        CliCommand::Live(command) => commands::live::run(command),
        #[cfg(feature = "bridge")]
        CliCommand::Brokers(command) => commands::brokers::run(command),
        #[cfg(feature = "sunrise")]
        CliCommand::Sunrise(command) => commands::sunrise::run(command),
        CliCommand::Fk(options) => commands::fk::run(&options),
        CliCommand::Ik(options) => commands::ik::run(&options),
        CliCommand::Robot(options) => commands::robot::run(&options),
        CliCommand::Schema(options) => commands::schema::run(&options),
        CliCommand::Completions(options) => commands::completions::run(&options),
        CliCommand::Man(options) => commands::man::run(&options),
    }
}
