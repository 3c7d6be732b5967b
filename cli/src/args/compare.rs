//! `iiwasim compare`.

use std::path::PathBuf;

use clap::Args;

use super::{LogReading, values::at_least_0};

/// Compare a recording with a plan: cycle time error, path deviation, and torques if recorded.
///
/// The cycle time error is the planned time minus the measured time, in s and in per cent of the
/// measured time. A recording shows when the arm leaves the start and reaches the end, but not how
/// long the arm waits there. The measured time is therefore the time from start to end, plus the
/// planned standstill before the first and after the last motion. A motion is timed from the
/// instant at which the arm passes its planned start to the instant at which it passes its planned
/// end.
///
/// The path is compared regardless of time. Two distances of each sample from the nearest point of
/// the planned path are computed: in joint space (Euclidean norm of the seven angles), and at the
/// flange. The mean along the path and the maximum of each are printed. Noise of the recording
/// counts as distance.
///
/// If the recording contains several runs of the program, the first run is used. A recording whose
/// path is far from the plan's, or that contains only a part of the program, is rejected.
///
/// The exit code is 3 if an error exceeds its gate, and 2 if the files cannot be compared;
/// otherwise it is 0. Without gates, errors of any size give 0.
#[derive(Args, Debug)]
pub(crate) struct Compare {
    /// The plan: an MCAP file of `iiwasim plan`
    #[arg(value_name = "PLAN.mcap")]
    pub(crate) plan: PathBuf,

    /// The recording: an MCAP file of `iiwasim run` or `record`, a `DataRecorder` log, or a CSV
    /// file with the columns `t_s` and `joint_1_rad` (or `_deg`) to `joint_7_rad`
    #[arg(value_name = "MEASURED")]
    pub(crate) measured: PathBuf,

    /// Print a JSON object
    #[arg(long)]
    pub(crate) json: bool,

    /// Gate: exit with code 3 if the cycle time error is above this in magnitude, in per cent
    #[arg(long, value_name = "P", value_parser = at_least_0)]
    pub(crate) max_error_percent: Option<f64>,

    /// Gate: exit with code 3 if the largest flange deviation is above this, in mm
    #[arg(long, value_name = "D", value_parser = at_least_0)]
    pub(crate) max_deviation_mm: Option<f64>,

    /// Draw both flange paths, and the deviations along the path, as a picture
    #[arg(long, value_name = "FILE.svg|png|pdf")]
    pub(crate) picture: Option<PathBuf>,

    /// Built-in model or robot profile, instead of the plan's
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    #[command(flatten)]
    pub(crate) log: LogReading,
}
