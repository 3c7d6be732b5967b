//! `iiwasim report`.

use std::path::PathBuf;

use clap::Args;

use super::{LogReading, Urdf};

/// Make an HTML page of a plan or a recording: moving arm, path, joint curves, motions.
///
/// The page is one HTML file that needs no network: the arm in 3D, with controls to play, pause,
/// seek and change the speed; the flange path with its blends, and a sphere for each blend that has
/// a radius; position, velocity, acceleration, jerk and torque (link side) of the joints with their
/// limits; the start, duration and active limit of each motion. With a second file, the page also
/// shows the measured arm and the errors of the plan, as `iiwasim compare` computes them; with
/// --scene, the obstacles, the tool and the clearance over time.
///
/// A recording of `iiwasim run` or `iiwasim experiment` contains its program, so its page also
/// shows the plan of this program beside the recording. Other recordings do not contain a program:
/// their pages show neither a plan nor a list of motions. A truncated file is shown up to its end,
/// with a note. Curves of long files are drawn at the resolution of the screen: each pixel column
/// shows the range from the smallest to the largest value.
#[derive(Args, Debug)]
pub(crate) struct Report {
    /// An MCAP file of `iiwasim plan`, `run` or `record`, a `DataRecorder` log, or a CSV file with
    /// the columns `t_s` and `joint_1_rad` (or `_deg`) to `joint_7_rad`
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    /// Recording to compare with, in any of these formats; only if FILE is a plan
    #[arg(value_name = "MEASURED")]
    pub(crate) measured: Option<PathBuf>,

    /// Scene in JSON (`iiwasim schema scene`): the page shows obstacles, tool and clearance over
    /// time
    #[arg(long, value_name = "FILE")]
    pub(crate) scene: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) arm: Urdf,

    /// Path of the page [default: the name of FILE with .html, in the current folder]
    #[arg(short, long, value_name = "FILE.html")]
    pub(crate) output: Option<PathBuf>,

    /// Built-in model or robot profile to use instead of the robot in the file
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    #[command(flatten)]
    pub(crate) log: LogReading,
}
