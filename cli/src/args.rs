//! The command line.

mod addresses;
mod answering;
mod bridge;
#[cfg(feature = "opcua")]
mod bridge_opcua;
#[cfg(feature = "ros2")]
mod bridge_ros2;
mod compare;
mod experiment;
mod export;
mod identify;
mod import;
mod link;
mod model;
mod plan;
mod report;
pub(crate) mod ros;
mod shell;
mod stored;
mod twin;
mod urdf;
mod values;

use std::ffi::OsString;

use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::settings::{self, Settings};

pub(crate) use addresses::{ClientKeys, DriveAddress, ServerKeys};
pub(crate) use answering::Answering;
pub(crate) use bridge::{Bridge, KafkaAccess, Mqtt};
#[cfg(feature = "opcua")]
pub(crate) use bridge_opcua::OpcUa;
#[cfg(feature = "ros2")]
pub(crate) use bridge_ros2::{RetimeGoals, Ros2};
pub(crate) use compare::Compare;
pub(crate) use experiment::{Experiment, ExperimentName};
pub(crate) use export::Export;
pub(crate) use identify::Identify;
pub(crate) use import::Import;
pub(crate) use link::{Cabinet, Drive, Io, IoAction, Keygen, Record, Run, Sensors, Status, Stop};
pub(crate) use model::{Fk, Format, Ik, Place, Robot, Schema};
pub(crate) use plan::{Plan, Timing};
pub(crate) use report::Report;
pub(crate) use ros::RosNaming;
pub(crate) use shell::{Completions, Man};
pub(crate) use stored::{History, Replay, Stored};
pub(crate) use twin::Twin;
pub(crate) use urdf::Urdf;

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  failed while running (a file could not be written, or an interrupt)
  2  wrong usage or invalid input
  3  done, but a gate such as --max-cycle-time was not met, or some of many programs failed";

const FILES: &str = "\
Files:
  What can be made again is replaced by what is of its kind: trajectories,
  tables, pictures, reports, the results of virtual robots. What was measured
  on a robot, or may have been edited by hand, is not: recordings, robot
  profiles, frames; --overwrite replaces them. Keys never are.";

/// Version, commit and abilities.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), env!("IIWASIM_BUILD"), ", with CURVE");

/// Motion simulator for the KUKA LBR iiwa: which path will the arm take through a motion program,
/// and how long will it take?
#[derive(Debug, Parser)]
#[command(name = "iiwasim", version = VERSION, after_help = format!("{EXIT_CODES}\n\n{FILES}\n\n{}", settings::HELP))]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

impl Arguments {
    /// The command line. The help of each command lists the exit codes.
    pub(crate) fn command_line() -> clap::Command {
        Self::command().mut_subcommands(|command| {
            // Else, a negative number would be taken for an option.
            let number = |arg: Arg| {
                if arg.is_positional() || !arg.get_action().takes_values() {
                    arg
                } else {
                    arg.allow_negative_numbers(true)
                }
            };
            command.mut_args(number).after_help(EXIT_CODES)
        })
    }

    /// Parses the arguments of this process with these settings as defaults; exits on wrong usage, and after printing
    /// help.
    pub(crate) fn read(settings: &Settings) -> Self {
        let command = Self::command_line().mut_subcommands(|command| settings.apply(command));
        let matches = command.get_matches_from(with_optional_values(std::env::args_os()));
        Self::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
    }
}

/// The arguments, with the value of an option that may go without one joined to it: `--limit-torque 80 FILE` and
/// `--limit-torque FILE` both say what they seem to.
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
pub(crate) enum Command {
    Plan(Plan),
    Run(Run),
    Compare(Compare),
    Report(Report),
    Identify(Identify),
    Experiment(Experiment),
    Twin(Twin),
    Record(Record),
    Bridge(Box<Bridge>),
    Replay(Replay),
    History(History),
    Status(Status),
    Stop(Stop),
    Io(Io),
    Sensors(Sensors),
    Drive(Drive),
    Cabinet(Cabinet),
    Keygen(Keygen),
    Fk(Fk),
    Ik(Ik),
    Import(Import),
    Export(Export),
    Robot(Robot),
    Schema(Schema),
    Completions(Completions),
    Man(Man),
}
