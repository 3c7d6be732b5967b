//! `iiwasim`: computes the path of the arm through a motion program, and its cycle time.
//!
//! Results go to standard output, everything else to standard error. Only this file sets the exit
//! code: 0 success; 1 failure at run time; 2 wrong usage or invalid input; 3 success, but a gate
//! was violated, or some of many programs failed.

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
mod trace;
#[cfg(feature = "live")]
mod twin_failure;

use std::process::ExitCode;

use args::{Arguments, Command};
use failure::{Failure, print_note};
use settings::Settings;

fn main() -> ExitCode {
    let result = Settings::read().map_or_else(
        |failure| {
            // Help must work with invalid settings.
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
        Command::Compare(options) => commands::compare::run(&options),
        Command::Validate(options) => commands::validate::run(&options),
        Command::Report(options) => commands::report::run(&options),
        Command::Identify(options) => commands::identify::run(&options),
        #[cfg(feature = "live")]
        Command::Live(command) => commands::live::run(command),
        #[cfg(feature = "bridge")]
        Command::Brokers(command) => commands::brokers::run(command),
        #[cfg(feature = "sunrise")]
        Command::Sunrise(command) => commands::sunrise::run(command),
        Command::Fk(options) => commands::fk::run(&options),
        Command::Ik(options) => commands::ik::run(&options),
        Command::Robot(options) => commands::robot::run(&options),
        Command::Schema(options) => commands::schema::run(&options),
        Command::Completions(options) => commands::completions::run(&options),
        Command::Man(options) => commands::man::run(&options),
    }
}
