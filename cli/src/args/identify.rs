//! `iiwasim identify`.

use std::path::PathBuf;

use clap::Args;

use super::{LogReading, values::override_percent};

/// Identify a robot's limits, settling time and blend curves from recordings.
///
/// Each recording is matched with its program from stop to stop. Limits are identified from
/// straight-line motions from rest to rest: the whole motion is fitted instead of differentiated,
/// so that noise averages out. Long motions of single joints at full speed are the most useful;
/// motions of several joints are used if a single joint must have been the limiting one. If
/// constant jerk does not explain a motion, Sunrise's ramps with constant snap are fitted, and S
/// and R of `ramps` in profiles are identified. The settling time is identified from stops between
/// such motions, kappa from blends, regardless of time; for blends between two LINs from the TCP
/// path, as `tcp_blend_kappa`. TCP paths and their blends are compared with iiwasim's assumptions:
/// orientation, E1, and blends with PTP motions. For that, the controller itself must have planned
/// them: trajectories that a drive streamed show iiwasim's own blends.
///
/// Each figure has its uncertainty, half of the 95 % confidence interval, and the number of
/// observations. Parameters that the recordings do not determine keep the values of the model.
/// Commanded positions of a `DataRecorder` log are preferred: measured ones lag by some ms, so that
/// jerk is underestimated.
///
/// The resulting profile works with `iiwasim plan --robot PROFILE.json`. `iiwasim experiment` makes
/// programs from which all of it can be identified.
#[derive(Args, Debug)]
pub(crate) struct Identify {
    /// Recordings: MCAP files of `iiwasim run` or `experiment`, which contain their programs, or,
    /// with --program, of `iiwasim record`, `DataRecorder` logs or CSV files with the columns `t_s`
    /// and `joint_1_rad` (or `_deg`) to `joint_7_rad`
    #[arg(value_name = "RECORDING", required = true)]
    pub(crate) recordings: Vec<PathBuf>,

    /// Program of all recordings, run once or repeatedly [default: the program in each recording]
    #[arg(long, value_name = "PROGRAM.json")]
    pub(crate) program: Option<PathBuf>,

    /// Built-in model or robot profile for lengths, ranges and all figures that are not identified
    /// [default: the recordings' or the programs']
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Path of the profile
    #[arg(short, long, value_name = "PROFILE.json", default_value = "identified.json")]
    pub(crate) output: PathBuf,

    /// Replace an existing profile, which may have been edited by hand
    #[arg(long, conflicts_with = "no_output")]
    pub(crate) overwrite: bool,

    /// Print the figures only, write no profile
    #[arg(long, conflicts_with_all = ["output", "name"])]
    pub(crate) no_output: bool,

    /// Name of the robot in the profile [default: the model's]
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,

    /// Print the figures as a JSON object, with all motions and blends
    #[arg(long)]
    pub(crate) json: bool,

    /// Speed override during the recordings, in per cent, instead of the program's: scales speeds,
    /// its square accelerations, its cube jerks; pauses are not scaled. The figures are for 100 %
    #[arg(long = "override", value_name = "PERCENT", value_parser = override_percent)]
    pub(crate) speed_override: Option<f64>,

    #[command(flatten)]
    pub(crate) log: LogReading,
}
