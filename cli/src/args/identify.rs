//! `iiwasim identify`.

use std::path::PathBuf;

use clap::Args;

use super::{LogReading, log_reading::COMMANDED_PREFERRED, values::override_percent};

/// Identify a robot's limits, settling time and blend curves from recordings.
///
/// Each recording is matched with the path of its program, section by section (a section is the
/// part between two stops). Limits are identified from PTP motions from rest to rest: a model is
/// fitted to the whole motion, and nothing is differentiated, so that noise averages out. Long
/// motions of single joints at full speed are the most useful; a motion of several joints is used
/// only if it is clear which joint limited it. If constant jerk does not fit a motion, acceleration
/// ramps with constant snap (the derivative of jerk) are fitted instead, as in Sunrise's motions.
/// The limits of these ramps are written to `ramps` in the profile: snap limits of joints, jerk
/// limits for starts, and jerk limits for stops. The settling time is identified from the stops
/// between PTP motions.
///
/// kappa is a number that describes the shape of a blend. It is identified from the path alone,
/// regardless of time: in joint space for blends between PTP motions (`blend_kappa` in the
/// profile), and from the TCP path for blends between LIN motions (`tcp_blend_kappa`). Payload and
/// friction are identified from measured torques.
///
/// Three things are compared with iiwasim's assumptions: the recorded orientation on TCP paths, the
/// recorded position of the elbow there (the redundancy angle E1, which the TCP pose leaves free),
/// and blends between PTP motions and TCP paths. This comparison is useful only if the robot's
/// controller planned the motions: set-points that a drive has streamed follow the path that
/// iiwasim planned.
///
/// Each figure is printed with its uncertainty (half of the 95 % confidence interval) and the
/// number of observations. Parameters that the recordings do not determine keep the values of the
/// model. In a `DataRecorder` log, commanded positions are preferred: measured positions lag by a
/// few ms, and the jerk identified from them is too low.
///
/// The resulting profile works with `iiwasim plan --robot PROFILE.json`. `iiwasim experiment` runs
/// programs with suitable motions.
#[derive(Args, Debug)]
#[command(mut_arg("positions", |arg| arg.help(COMMANDED_PREFERRED)))]
pub(crate) struct Identify {
    /// Recordings: MCAP files of `iiwasim run` or `experiment`, which contain their programs. With
    /// --program also MCAP files of `iiwasim record`, `DataRecorder` logs, and CSV files with the
    /// columns `t_s` and `joint_1_rad` (or `_deg`) to `joint_7_rad`
    #[arg(value_name = "RECORDING", required = true)]
    pub(crate) recordings: Vec<PathBuf>,

    /// Program of all recordings, run once or repeatedly [default: the program in each recording]
    #[arg(long, value_name = "PROGRAM.json")]
    pub(crate) program: Option<PathBuf>,

    /// Built-in model or robot profile for link lengths, joint ranges and all figures that are not
    /// identified [default: the robot of the recordings or of their programs]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Path of the profile
    #[arg(short, long, value_name = "PROFILE.json", default_value = "identified.json")]
    pub(crate) output: PathBuf,

    /// Replace an existing profile, which may have been edited by hand
    #[arg(long, conflicts_with = "no_output")]
    pub(crate) overwrite: bool,

    /// Only print the figures; write no profile
    #[arg(long, conflicts_with_all = ["output", "name"])]
    pub(crate) no_output: bool,

    /// Name of the robot in the profile [default: the model's]
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,

    /// Print the figures as a JSON object, with all motions and blends
    #[arg(long)]
    pub(crate) json: bool,

    /// Speed override during the recordings, in per cent, instead of the program's. Identified
    /// limits are converted to 100 %: speeds are proportional to the override, accelerations to its
    /// square, jerks to its cube. The settling time does not depend on it
    #[arg(long = "override", value_name = "PERCENT", value_parser = override_percent)]
    pub(crate) speed_override: Option<f64>,

    #[command(flatten)]
    pub(crate) log: LogReading,
}
