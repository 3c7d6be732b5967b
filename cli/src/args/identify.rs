//! Identifying a robot.

use std::path::PathBuf;

use clap::Args;

/// Find a robot's limits, its time to settle and the curve of its blends in recordings of it.
///
/// Each recording is followed along its program from stop to stop. Limits come from motions along lines
/// from rest to rest: their whole course is fitted, nothing is differentiated, so that noise is averaged
/// out. Single joints that move far at full speed show the most; of motions of several joints, those are
/// used of which one joint must have been the limit. The time to settle comes from stops between such
/// motions, kappa from blends, whatever their time.
///
/// Each figure is told with its uncertainty, half of the interval that holds the true one in 95 of 100
/// cases, and with the number of observations. What the recordings do not show is not told, and stays as
/// it is in the model. Positions are taken at their word: measured ones that lag behind the commanded ones
/// by some ms make jerk and the time to settle look smaller, so that commanded ones are better.
///
/// The profile that it writes works with `iiwasim plan --robot PROFILE.json`. `iiwasim experiment` makes
/// programs that show all of it.
#[derive(Args, Debug)]
pub(crate) struct Identify {
    /// What the robot did: MCAP files of `iiwasim run` or `experiment`, which hold their programs, or with
    /// --program of `iiwasim record`, `DataRecorder` logs or CSV files with the columns `t_s` and
    /// `joint_1_rad` (or `_deg`) to `joint_7_rad`
    #[arg(value_name = "RECORDING", required = true)]
    pub(crate) recordings: Vec<PathBuf>,

    /// The program that the robot ran in all recordings, once or again and again [default: the one in
    /// each recording]
    #[arg(long, value_name = "PROGRAM.json")]
    pub(crate) program: Option<PathBuf>,

    /// Built-in model or robot profile that the robot is taken for: its lengths, ranges and what is not
    /// found [default: the recordings' or the programs']
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Where the profile goes
    #[arg(short, long, value_name = "PROFILE.json", default_value = "identified.json")]
    pub(crate) output: PathBuf,

    /// Print the figures, write no profile
    #[arg(long, conflicts_with_all = ["output", "name"])]
    pub(crate) no_output: bool,

    /// The robot's name in the profile [default: the model's]
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,

    /// Print the figures as one JSON object, with all motions and blends
    #[arg(long)]
    pub(crate) json: bool,
}
