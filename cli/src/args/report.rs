//! `iiwasim report`.

use std::path::PathBuf;

use clap::Args;

use super::{LogReading, Urdf};

/// Make an HTML page of a plan or a recording: moving arm, path, joint curves, motions.
///
/// The page is one HTML file that needs no network: the arm in 3D with play, pause, scrub and
/// speed; the flange path with blends and blend spheres; position, velocity, acceleration, jerk and
/// torque (link side) of the joints with their limits; the start, duration and active limit of each
/// motion. With a second file, the page also shows the measured arm and the errors of `iiwasim
/// compare`; with --scene, the obstacles, the tool and the clearance over time.
///
/// A recording of `iiwasim run` contains its program and is shown beside its plan. Other recordings
/// do not contain a program: their page has neither a plan nor the list of motions. A truncated
/// file is shown up to its end, with a note. Long files are reduced to the width of the screen:
/// each pixel column of a curve spans the minimum and the maximum of its samples.
#[derive(Args, Debug)]
pub(crate) struct Report {
    /// An MCAP file of `iiwasim plan`, `run` or `record`, a `DataRecorder` log, or a CSV file with
    /// the columns `t_s` and `joint_1_rad` (or `_deg`) to `joint_7_rad`
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    /// Recording of the robot, in any of these formats, if FILE is a plan
    #[arg(value_name = "MEASURED")]
    pub(crate) measured: Option<PathBuf>,

    /// Scene in JSON (`iiwasim schema scene`): the page shows obstacles, tool and clearance over
    /// time
    #[arg(long, value_name = "FILE")]
    pub(crate) scene: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) arm: Urdf,

    /// Path of the page [default: FILE.html in the current folder]
    #[arg(short, long, value_name = "FILE.html")]
    pub(crate) output: Option<PathBuf>,

    /// Built-in model or robot profile, instead of the file's
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    #[command(flatten)]
    pub(crate) log: LogReading,
}
