//! `iiwasim identify`.

use std::path::PathBuf;

use clap::Args;

use super::{LogReading, values::override_percent};

/// Identify a robot's limits, its time to settle and the curve of its blends from recordings.
///
/// Each recording is matched with its program from stop to stop. Limits are identified from motions along
/// lines from rest to rest: the whole motion is fitted instead of differentiated, so that noise averages
/// out. Long motions of single joints at full speed are the most useful; of motions of several joints,
/// those are used in which a single joint must have been the limit. Where constant jerk does not explain a motion, the ramps of
/// Sunrise are fitted to it, which begin with constant snap, and their law is identified: S and R of `ramps` in profiles. The time to settle is identified from
/// stops between such motions, kappa from blends, regardless of time; of blends between two LINs by the
/// TCP's path, as `tcp_blend_kappa`. Paths of the TCP and the blends at their ends are compared with what
/// iiwasim assumes of them: orientation, E1, and blends with motions in joint space. For that, the
/// controller must have done them: what a drive ran as a trajectory shows iiwasim's own blends.
///
/// Each figure has its uncertainty, half of the 95 % confidence interval, and the number of observations.
/// Parameters that the recordings do not determine keep the values of the model. Commanded positions of a
/// `DataRecorder` log are preferred: measured ones lag by some ms, so that jerk is underestimated.
///
/// The resulting profile works with `iiwasim plan --robot PROFILE.json`. `iiwasim experiment` makes
/// programs from which all of it can be identified.
#[derive(Args, Debug)]
pub(crate) struct Identify {
    /// Recordings: MCAP files of `iiwasim run` or `experiment`, which contain their programs, or, with
    /// --program, of `iiwasim record`, `DataRecorder` logs or CSV files with the columns `t_s` and
    /// `joint_1_rad` (or `_deg`) to `joint_7_rad`
    #[arg(value_name = "RECORDING", required = true)]
    pub(crate) recordings: Vec<PathBuf>,

    /// The program that the robot ran in all recordings, once or repeatedly [default: the one in each
    /// recording]
    #[arg(long, value_name = "PROGRAM.json")]
    pub(crate) program: Option<PathBuf>,

    /// Built-in model or robot profile for lengths, ranges and everything that is not identified [default:
    /// the recordings' or the programs']
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

    /// Override of the robot during the recordings, in per cent, instead of the program's: speeds are scaled by it, accelerations by its square, jerks by
    /// its cube, pauses are not; the figures are those at 100 %
    #[arg(long = "override", value_name = "PERCENT", value_parser = override_percent)]
    pub(crate) speed_override: Option<f64>,

    #[command(flatten)]
    pub(crate) log: LogReading,
}
