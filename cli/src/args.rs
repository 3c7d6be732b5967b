//! The command line.

mod addresses;
mod compare;
mod experiment;
mod identify;
mod import;
mod link;
mod model;
mod plan;
mod report;
mod twin;
mod urdf;
mod values;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

pub(crate) use addresses::{ClientKeys, DriveAddress, ServerKeys};
pub(crate) use compare::Compare;
pub(crate) use experiment::{Experiment, ExperimentName};
pub(crate) use identify::Identify;
pub(crate) use import::Import;
pub(crate) use link::{Cabinet, Drive, Io, IoAction, Keygen, Record, Run, Sensors, Status, Stop};
pub(crate) use model::{Fk, Format, Ik, Place, Robot, Schema};
pub(crate) use plan::{Plan, Timing};
pub(crate) use report::Report;
pub(crate) use twin::Twin;
pub(crate) use urdf::Urdf;

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  failed while running (a file could not be written, or an interrupt)
  2  wrong usage or invalid input
  3  done, but a gate such as --max-cycle-time was not met, or some of many programs failed";

/// Motion simulator for the KUKA LBR iiwa: which path will the arm take through a motion program,
/// and how long will it take?
#[derive(Debug, Parser)]
#[command(name = "iiwasim", version, after_help = EXIT_CODES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

impl Arguments {
    /// Parses the arguments of this process; exits on wrong usage, and after printing help. The help of each
    /// command lists the exit codes.
    pub(crate) fn read() -> Self {
        let command = Self::command().mut_subcommands(|command| command.after_help(EXIT_CODES));
        Self::from_arg_matches(&command.get_matches()).unwrap_or_else(|error| error.exit())
    }
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
    Robot(Robot),
    Schema(Schema),
}
