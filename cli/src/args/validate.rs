//! `iiwasim validate`.

use std::path::PathBuf;

use clap::Args;

use super::{LogReading, Timing, values::override_percent};

/// Validate the simulation: plan a program, compare the plan with a recording of a robot that ran it, print table and score.
///
/// The table has a row for each motion: its planned and its measured duration, the error in per cent of the measured one, how far the
/// worst joint is off the path, wherever in time, and how far the flange is. Below it are the errors' median, the value
/// that 95 % of the motions do not exceed, and the worst; the robot, the timing and the override; and what the plan assumes.
///
/// The output is meant to be sent: it names files without their folders, and nothing else of the machine. `iiwasim compare`
/// has more about one recording, and gates.
///
/// The recording may hold more than the program; the first run counts. Commanded positions of a `DataRecorder` log are
/// preferred.
#[derive(Args, Debug)]
pub(crate) struct Validate {
    /// The program that the robot ran
    #[arg(value_name = "PROGRAM.json")]
    pub(crate) program: PathBuf,

    /// The recording: a `DataRecorder` log, an MCAP file of `iiwasim run` or `record`, or a CSV file with the columns
    /// `t_s` and `joint_1_rad` (or `_deg`) to `joint_7_rad`
    #[arg(value_name = "RECORDING")]
    pub(crate) recording: PathBuf,

    /// Print a JSON object
    #[arg(long)]
    pub(crate) json: bool,

    /// Limits that the plan keeps
    #[arg(long, value_enum, default_value_t = Timing::Sunrise)]
    pub(crate) timing: Timing,

    /// Override of the robot during the recording, in per cent: motions take so much longer, waits do not
    #[arg(long = "override", value_name = "PERCENT", value_parser = override_percent)]
    pub(crate) speed_override: Option<f64>,

    /// Built-in model or robot profile, instead of the program's
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    #[command(flatten)]
    pub(crate) log: LogReading,
}
