//! `iiwasim validate`.

use std::path::PathBuf;

use clap::Args;

use super::{LogReading, Timing, log_reading::COMMANDED_PREFERRED, values::override_percent};

/// Plan a program, compare the plan with a recording of a real run, and print a table and a score.
///
/// The table has one row per motion: planned and measured duration, the error in per cent of the
/// measured duration, and the largest path deviation of a joint and of the flange, regardless of
/// time. Below the table are the median, 95th percentile and maximum of the errors, the robot, the
/// timing, the override, and the assumptions of the plan.
///
/// The output can be shared: it contains file names without folders, and no other data of the
/// machine. `iiwasim compare` prints more about one recording, and has gates.
///
/// The recording may be longer than the program; the first run is used. Commanded positions of a
/// `DataRecorder` log are preferred.
#[derive(Args, Debug)]
#[command(mut_arg("positions", |arg| arg.help(COMMANDED_PREFERRED)))]
pub(crate) struct Validate {
    /// The program that the robot ran
    #[arg(value_name = "PROGRAM.json")]
    pub(crate) program: PathBuf,

    /// The recording: a `DataRecorder` log, an MCAP file of `iiwasim run` or `record`, or a CSV
    /// file with the columns `t_s` and `joint_1_rad` (or `_deg`) to `joint_7_rad`
    #[arg(value_name = "RECORDING")]
    pub(crate) recording: PathBuf,

    /// Print a JSON object
    #[arg(long)]
    pub(crate) json: bool,

    /// Timing method of the plan
    #[arg(long, value_enum, default_value_t = Timing::Sunrise)]
    pub(crate) timing: Timing,

    /// Speed override during the recording, in per cent, instead of the program's: slows down
    /// motions, but neither the standstill after stops nor waits
    #[arg(long = "override", value_name = "PERCENT", value_parser = override_percent)]
    pub(crate) speed_override: Option<f64>,

    /// Built-in model or robot profile, instead of the program's
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    #[command(flatten)]
    pub(crate) log: LogReading,
}
