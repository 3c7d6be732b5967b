//! `iiwasim plan`.

use std::{path::PathBuf, time::Duration};

use bytesize::ByteSize;
use clap::{Args, ValueEnum};
use iiwa_path::{BlendSearch, BlendShape, Continuity};

use super::values::{at_least_0, epoch, rate};

/// Plan motion programs: print their cycle times, write their trajectories as MCAP.
///
/// The table has a row for each motion: when it starts and ends, its top speed as a share of the
/// joint's speed limit, and the limits that it is at for most of its time, with their shares of it;
/// --json has all of them. A motion lasts from the start of the blend that leads into it to the start
/// of the blend that leads out of it, or to its stop.
///
/// The MCAP file opens in Foxglove, Lichtblick, Rerun and ROS 2 tools: joint states, link frames,
/// the flange's pose, the whole trajectory, the robot's URDF and the program.
///
/// Many programs are planned on all cores: `iiwasim plan A.json B.json`, or `iiwasim plan FOLDER`
/// for all files *.json directly in it, by name, but for hidden ones, robot profiles and scenes. The table
/// then has a row for each program: how long it takes, moving and standing (to settle and to wait),
/// and what limits most of its time in motion. A program that fails is named on standard error and
/// does not stop the others; the exit code is 3 then.
#[derive(Args, Debug)]
pub(crate) struct Plan {
    /// Motion program in JSON (`iiwasim schema` describes it), or a folder of them; - reads
    /// standard input
    #[arg(value_name = "PROGRAM.json", required = true)]
    pub(crate) programs: Vec<PathBuf>,

    /// Where the MCAP file goes; of many programs, the folder for their files, made if there is
    /// none [default: PROGRAM.mcap in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Print the figures, write no trajectory
    #[arg(long, conflicts_with_all = ["output", "rate", "epoch", "max_file_size"])]
    pub(crate) no_output: bool,

    /// Print the figures as one JSON object; of many programs, one a line
    #[arg(long)]
    pub(crate) json: bool,

    /// Programs that are planned at the same time, 1 to 1024 [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,

    /// Which limits the motion keeps
    #[arg(long, value_enum, default_value_t = Timing::Jerk)]
    pub(crate) timing: Timing,

    /// Curve of the blends
    #[arg(long, value_enum, default_value_t = Shape::Iiwa)]
    pub(crate) blend_shape: Shape,

    /// How the start and end of a blend given in mm are found
    #[arg(long, value_enum, default_value_t = Search::FirstCrossing)]
    pub(crate) blend_search: Search,

    /// Samples a blend for timing by acceleration, 2 to 100000; more is more exact and slower
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub(crate) samples: u32,

    /// Joint states a second in the MCAP file, 0.1 to 100000
    #[arg(long, value_name = "HZ", default_value_t = 250.0, value_parser = rate)]
    pub(crate) rate: f64,

    /// Write no MCAP file that would be larger, as 500MB or 5GB: a program at a millionth of its speed takes
    /// months, and its samples any disk. How large it would be is estimated before anything is sampled
    #[arg(long, value_name = "SIZE", default_value = "1GB")]
    pub(crate) max_file_size: ByteSize,

    /// Built-in model or robot profile, instead of the program's
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Exit with code 3 if a program takes longer, in s: a gate for CI
    #[arg(long, value_name = "S", value_parser = at_least_0)]
    pub(crate) max_cycle_time: Option<f64>,

    /// Scene in JSON (`iiwasim schema scene` describes it): tells how near the arm comes to its obstacles
    #[arg(long, value_name = "SCENE.json")]
    pub(crate) scene: Option<PathBuf>,

    /// Exit with code 3 if the arm comes nearer to an obstacle of the scene, in mm, or touches one: a gate
    /// for CI
    #[arg(long, value_name = "MM", value_parser = at_least_0, requires = "scene")]
    pub(crate) min_clearance: Option<f64>,

    /// Instant at which the file's stamps start, from 1970 to 2037, as 2020-01-01T00:00:00Z
    #[arg(long, value_name = "TIME", value_parser = epoch)]
    pub(crate) epoch: Option<Duration>,

    /// Draw the path of the flange and the joint speeds as a picture, too; of one program only
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) picture: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Timing {
    /// Velocity and acceleration (Larsen 2019)
    Acceleration,
    /// Velocity, acceleration and jerk, as the controller does it
    Jerk,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Shape {
    /// What the LBR iiwa does (Larsen 2019, Eq. 39)
    Iiwa,
    /// Polynomial without shaping (Eq. 13)
    Alpha,
    /// Polynomial of least mean acceleration (Eq. 26)
    MinAcceleration,
    /// Circle in joint space (Eq. 32); not with limits on jerk
    Circle,
}

impl From<Shape> for BlendShape {
    fn from(shape: Shape) -> Self {
        match shape {
            Shape::Iiwa => Self::Iiwa,
            Shape::Alpha => Self::Alpha(Continuity::Second),
            Shape::MinAcceleration => Self::MinAcceleration,
            Shape::Circle => Self::Circle,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Search {
    /// The crossing of the sphere nearest to the target, provably
    FirstCrossing,
    /// Bisection (Larsen 2019, Algorithm 1)
    #[value(name = "algorithm-1")]
    Algorithm1,
    /// Steps of 0.001 (Larsen 2019, Algorithm 2)
    #[value(name = "algorithm-2")]
    Algorithm2,
}

impl From<Search> for BlendSearch {
    fn from(search: Search) -> Self {
        match search {
            Search::FirstCrossing => Self::FirstCrossing,
            Search::Algorithm1 => Self::Algorithm1,
            Search::Algorithm2 => Self::Algorithm2,
        }
    }
}
