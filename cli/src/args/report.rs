//! `iiwasim report`.

use std::path::PathBuf;

use clap::Args;

use super::{LogReading, Urdf};

/// Make a page of a plan or a recording: the arm in motion, its path, its joints over time, its motions.
///
/// The page is one HTML file that needs no network: the arm in 3D with play, pause, scrub and speed;
/// the path of the flange with the blends and their spheres; position, velocity, acceleration, jerk
/// and torque (link side) of the joints next to their limits; when each motion runs and what limits it. With a second
/// file, both arms and the errors that `iiwasim compare` finds. With --scene, the obstacles, the tool and the
/// clearance over time.
///
/// A recording of `iiwasim run` contains its program, and is shown beside the plan of it. Other
/// recordings have no motions, and the page shows the rest. A truncated file is shown up to its end,
/// with a note. Long files are reduced for the screen: each column of a curve spans from its lowest to
/// its highest value.
#[derive(Args, Debug)]
pub(crate) struct Report {
    /// An MCAP file of `iiwasim plan`, `run` or `record`, a `DataRecorder` log, or a CSV file with the
    /// columns `t_s` and `joint_1_rad` (or `_deg`) to `joint_7_rad`
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    /// Recording of the robot, in any of these formats, if FILE is a plan
    #[arg(value_name = "MEASURED")]
    pub(crate) measured: Option<PathBuf>,

    /// Scene in JSON (`iiwasim schema scene` describes it): the page shows obstacles and tool, and the clearance of the arm
    /// over time
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
