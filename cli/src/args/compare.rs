//! Holding a recording against a plan.

use std::path::PathBuf;

use clap::Args;

use super::values::at_least_0;

/// Hold a recording against a plan: how far the cycle time was off, and how far the arm was off its
/// path.
///
/// The cycle time's error is the simulated time minus the real one, in s and in per cent of the real
/// one. The recording shows when the arm leaves its start and when it arrives at its end, whatever it
/// does before and after; for how long the plan stands there, to settle and to wait, is added to the
/// real time, too. Each motion's time is compared in the same way: between the places at which the plan
/// starts and ends it.
///
/// The path is compared whatever the time: each sample's distance to the nearest place of the planned
/// path, in joint space and at the flange, the mean along the path and the largest one. Noise of the
/// recording counts as distance.
///
/// If the program is in the recording more than once, the first time counts. A recording of another
/// program, or of a part of the program, is refused.
#[derive(Args, Debug)]
pub(crate) struct Compare {
    /// What was planned: an MCAP file of `iiwasim plan`
    #[arg(value_name = "PLAN.mcap")]
    pub(crate) plan: PathBuf,

    /// What the robot did: an MCAP file of `iiwasim run` or `record`, a `DataRecorder` log, or a CSV
    /// file with the columns `t_s` and `joint_1_rad` (or `_deg`) to `joint_7_rad`
    #[arg(value_name = "MEASURED")]
    pub(crate) measured: PathBuf,

    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,

    /// Exit with code 3 if the cycle time is off by more, either way, in per cent
    #[arg(long, value_name = "P", value_parser = at_least_0)]
    pub(crate) max_error_percent: Option<f64>,

    /// Exit with code 3 if the flange is off its path by more anywhere, in mm
    #[arg(long, value_name = "D", value_parser = at_least_0)]
    pub(crate) max_deviation_mm: Option<f64>,

    /// Draw both paths of the flange, and the deviations along the path, as a picture
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) picture: Option<PathBuf>,

    /// Built-in model or robot profile, instead of the plan's
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,
}
