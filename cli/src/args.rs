//! The command line.

#[cfg(feature = "live")]
mod addresses;
mod answering;
#[cfg(feature = "bridge")]
mod bridge;
#[cfg(feature = "opcua")]
mod bridge_opcua;
#[cfg(feature = "ros2")]
mod bridge_ros2;
#[cfg(feature = "bridge")]
mod broker_access;
mod compare;
mod diff;
#[cfg(feature = "live")]
mod experiment;
#[cfg(feature = "sunrise")]
mod export;
mod identify;
#[cfg(feature = "sunrise")]
mod import;
#[cfg(feature = "live")]
mod link;
mod log_reading;
mod model;
mod plan;
mod report;
#[cfg(feature = "live")]
mod robot_values;
pub(crate) mod ros;
#[cfg(feature = "optimise")]
mod search;
mod shell;
#[cfg(feature = "bridge")]
mod stored;
#[cfg(feature = "live")]
mod twin;
mod urdf;
mod validate;
mod values;

use std::{
    env,
    ffi::{OsStr, OsString},
    io::{self, Write},
    process,
};

use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand, builder::Resettable};

use crate::{
    failure::{Failure, print_note},
    features,
    settings::{self, SettingsFile},
};

pub(crate) use answering::Answering;
#[cfg(feature = "opcua")]
pub(crate) use bridge_opcua::OpcUa;
#[cfg(feature = "ros2")]
pub(crate) use bridge_ros2::{RetimeGoals, Ros2};
pub(crate) use compare::Compare;
pub(crate) use diff::Diff;
pub(crate) use identify::Identify;
pub(crate) use log_reading::LogReading;
pub(crate) use model::{Fk, Ik, OutputFormat, Robot, Schema, ToolAndBase};
pub(crate) use plan::{Plan, Timing};
pub(crate) use report::Report;
pub(crate) use ros::RosNaming;
#[cfg(feature = "optimise")]
pub(crate) use search::{
    Advise, ChosenRows, Optimise, OrderTasks, PlaceRobot, SceneOptions, SearchInput, SearchOptions,
    SearchOutput,
};
pub(crate) use shell::{Completions, Man};
pub(crate) use urdf::Urdf;
pub(crate) use validate::Validate;
#[cfg(feature = "live")]
pub(crate) use {
    addresses::{ClientKeys, DriveAddress, ServerKeys},
    experiment::{Experiment, ExperimentName},
    link::{Cabinet, Drive, Io, IoAction, Keygen, Record, Run, Sensors, Status, Stop},
    twin::Twin,
};
#[cfg(feature = "bridge")]
pub(crate) use {
    bridge::{Bridge, Mqtt},
    broker_access::{BrokerAccess, KafkaAccess},
    stored::{History, Replay, Stored},
};
#[cfg(feature = "sunrise")]
pub(crate) use {export::Export, import::Import};

const EXIT_CODES: &str = "\
Exit codes:
  0  success
  1  failure at run time, such as a file that cannot be written, or an interrupt
  2  wrong usage or invalid input
  3  success, but a gate such as --max-cycle-time was violated, or some programs of several failed";

const FILES: &str = "\
Files:
  Trajectories, tables, pictures, reports and results of `experiment
  --simulate` replace an existing file of the same type; a file of another type
  is an error. Recordings of a robot, and files that may have been edited by
  hand (robot profiles, frames), are replaced only with --overwrite. Key files
  are never replaced.";

/// Returns exit codes, files, settings, and the commands that this build lacks.
fn help() -> String {
    let sections = [EXIT_CODES, FILES, settings::HELP].map(str::to_owned);
    sections.into_iter().chain(features::missing_commands()).collect::<Vec<_>>().join("\n\n")
}

/// Motion simulator for the KUKA LBR iiwa: which path will the arm take through a motion program,
/// and how long will it take?
#[derive(Debug, Parser)]
#[command(name = "iiwasim", version = features::version(), after_help = help())]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: CliCommand,
}

impl Arguments {
    /// Builds the command line. The help of each command lists the exit codes.
    pub(crate) fn command_line() -> clap::Command {
        Self::command().mut_subcommands(|command| {
            // Otherwise, clap would take a negative number for an option.
            let number = |arg: Arg| {
                if arg.is_positional() || !arg.get_action().takes_values() {
                    arg
                } else {
                    arg.allow_negative_numbers(true)
                }
            };
            command.mut_args(number).mut_args(without_empty_variable).after_help(EXIT_CODES)
        })
    }

    /// Parses the arguments of this process with these settings as defaults; exits on wrong usage,
    /// and after printing help.
    pub(crate) fn read(settings: &SettingsFile) -> Self {
        let command = Self::command_line().mut_subcommands(|command| settings.apply(command));
        let arguments = with_optional_values(std::env::args_os());
        let matches = command
            .try_get_matches_from(arguments)
            .unwrap_or_else(|error| leave(&features::explain(error)));
        Self::from_arg_matches(&matches).unwrap_or_else(|error| leave(&error))
    }
}

/// Ignores an empty variable: compose files and CI set variables that have no value.
fn without_empty_variable(arg: Arg) -> Arg {
    let is_empty = |name: &OsStr| env::var_os(name).is_some_and(|value| value.is_empty());
    if arg.get_env().is_some_and(is_empty) { arg.env(Resettable::Reset) } else { arg }
}

/// Prints help, the version or an error, and exits. Unlike [`clap::Error::exit`], this reports a
/// standard output that cannot be written.
fn leave(error: &clap::Error) -> ! {
    let printed = error.print().and_then(|()| io::stdout().flush());
    match printed {
        Err(failure) if !error.use_stderr() && failure.kind() != io::ErrorKind::BrokenPipe => {
            print_note(&Failure::run("cannot write to standard output", &failure).text());
            process::exit(1)
        }
        _ => process::exit(error.exit_code()),
    }
}

/// Joins the value of an option that may have none to the option, so that `--limit-torque 80 FILE`
/// and `--limit-torque FILE` both work as expected.
fn with_optional_values(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut all: Vec<OsString> = Vec::new();
    for argument in arguments {
        let number = argument.to_str().filter(|text| text.parse::<f64>().is_ok());
        match (all.last_mut(), number) {
            (Some(option), Some(number)) if option == "--limit-torque" => {
                option.push(format!("={number}"));
            }
            _ => all.push(argument),
        }
    }
    all
}

#[derive(Debug, Subcommand)]
pub(crate) enum CliCommand {
    Plan(Plan),
    Compare(Compare),
    Diff(Diff),
    #[cfg(feature = "optimise")]
    #[command(flatten)]
    Search(SearchCommand),
    Report(Report),
    Identify(Identify),
    Validate(Validate),
    #[cfg(feature = "live")]
    #[command(flatten)]
    Live(Live),
    #[cfg(feature = "bridge")]
    #[command(flatten)]
    Brokers(Brokers),
    #[cfg(feature = "sunrise")]
    #[command(flatten)]
    Sunrise(Sunrise),
    Fk(Fk),
    Ik(Ik),
    Robot(Robot),
    Schema(Schema),
    Completions(Completions),
    Man(Man),
}

#[cfg(feature = "optimise")]
#[derive(Debug, Subcommand)]
pub(crate) enum SearchCommand {
    Advise(Advise),
    Optimise(Optimise),
    Order(OrderTasks),
    Place(PlaceRobot),
}

#[cfg(feature = "live")]
#[derive(Debug, Subcommand)]
pub(crate) enum Live {
    Run(Run),
    Experiment(Experiment),
    Twin(Twin),
    Record(Record),
    Status(Status),
    Stop(Stop),
    Io(Io),
    Sensors(Sensors),
    Drive(Drive),
    Cabinet(Cabinet),
    Keygen(Keygen),
}

#[cfg(feature = "bridge")]
#[derive(Debug, Subcommand)]
pub(crate) enum Brokers {
    Bridge(Box<Bridge>),
    Replay(Replay),
    History(History),
}

#[cfg(feature = "sunrise")]
#[derive(Debug, Subcommand)]
pub(crate) enum Sunrise {
    Import(Import),
    Export(Export),
}
