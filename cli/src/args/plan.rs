//! `iiwasim plan`.

use std::{path::PathBuf, time::Duration};

use bytesize::ByteSize;
use clap::{Args, ValueEnum};
use iiwa_path::{BlendSearch, BlendShape, Continuity};
use iiwa_traj::SweepOptions;

use super::{
    Answering, RosNaming, Urdf,
    values::{at_least_0, epoch, override_percent, rate, torque_percent, whole},
};

/// Heading of the advanced options.
const METHOD: &str =
    "Methods of calculation (equation numbers: Larsen 2019, see docs/equations.md)";

/// Help of `--urdf`. It differs from the help in other commands, because `plan` makes no page that
/// shows the meshes.
const URDF: &str = "URDF with meshes (STL, OBJ or Collada): clearances are computed with their \
    convex hulls instead of the simple shapes of the arm; needs --scene. Its joints must match the \
    robot's";

/// Plan motion programs: print their cycle times, write their trajectories as MCAP.
///
/// The table has one row per motion, wait at rest, load change, output (`set`) and input
/// (`wait_for`). A wait that runs while the arm moves ("overlap") and ends before the arm stops has
/// no row; the table skips its number. The row of a motion contains its start time, its duration,
/// its top speed as a share of the joint speed limit, and the one or two limits that are active
/// longest, with their shares of the duration; shares below 5 % are left out. If no share reaches 5
/// %, the row names a single limit without a share: the limit that is active longest or, if none is
/// active, the limit that the motion approaches most closely. --json prints all active limits. The
/// time of a blend belongs to the motion after it: a motion ends where the next blend begins, or
/// where the arm stops. Below the table are the largest joint torque, as a share of the torque
/// limit, and the mechanical work of the joints (link side, without motor and rotor losses).
///
/// The MCAP file opens in Foxglove, Lichtblick, Rerun and ROS 2 tools. It contains joint states,
/// link frames, the flange pose, the whole trajectory, the robot's URDF and the program.
///
/// Many programs are planned on all cores: `iiwasim plan A.json B.json`, or `iiwasim plan FOLDER`
/// for all programs in the folder, sorted by name. Programs are its *.json files, except hidden
/// files, robot profiles, scenes, files of frames and JSON Schemas. A note names each file that is
/// left out, except hidden files. The table then has one row per program: cycle time, time in
/// motion, time at rest (settling and waiting), and the main limit. To find the main limit, the
/// whole duration of each motion is assigned to the limit that is active longest in this motion or,
/// if none is active, to the limit that the motion approaches most closely; the main limit has the
/// largest sum. A failed program is reported on standard error and does not stop the others; the
/// exit code is then 3.
///
/// `iiwasim plan PROJECT --application CLASS` plans an application of a Sunrise project, with the
/// options of `iiwasim import`.
#[derive(Args, Debug)]
#[command(mut_arg("urdf", |arg| arg.help(URDF)))]
#[expect(clippy::struct_excessive_bools, reason = "options are independent")]
pub(crate) struct Plan {
    /// Motion program in JSON (`iiwasim schema` describes it), a folder of programs, or `-` for
    /// standard input. With --application: the folder of a Sunrise project
    #[arg(value_name = "PROGRAM.json", required = true)]
    pub(crate) programs: Vec<PathBuf>,

    /// Path of the MCAP file; for many programs, the output folder, created if missing
    /// [default: PROGRAM.mcap in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Write no MCAP file
    #[arg(long, conflicts_with_all = ["output", "epoch"])]
    pub(crate) no_output: bool,

    /// Print the figures as a JSON object; for many programs, one object per line
    #[arg(long)]
    pub(crate) json: bool,

    /// Number of programs planned in parallel, 1 to 1024; for a single long program, number of
    /// threads that plan the parts between its stops [default: one per core]
    #[arg(long, value_name = "N", value_parser = whole::<u16, 1, 1024>)]
    pub(crate) jobs: Option<u16>,

    /// Timing method: the limits and laws that determine the speed. Plans with `--timing jerk`
    /// exceed velocity limits by at most 0.1 %, acceleration limits by 0.2 % and jerk limits by 2 %
    #[arg(long, value_enum, default_value_t = Timing::Sunrise, help_heading = METHOD)]
    pub(crate) timing: Timing,

    /// Also limit joint torques (link side) to this percentage of the robot's torque limits:
    /// motions that need more torque become slower, others are not affected. Overrides
    /// `limit_torque_percent` of the program. Without the option and without this key, torques are
    /// not limited, because no public source says whether Sunrise limits torques. The option
    /// without a value means 100 [PERCENT: 1 to 1000]
    #[arg(long, value_name = "PERCENT", num_args = 0..=1, require_equals = true,
        default_missing_value = "100",
        value_parser = torque_percent)]
    pub(crate) limit_torque: Option<f64>,

    /// Speed override of the controller in %, instead of the program's. Motions become slower;
    /// waits and the standstill after stops take as long as before
    #[arg(long = "override", value_name = "PERCENT", value_parser = override_percent)]
    pub(crate) speed_override: Option<f64>,

    /// Blend curve
    #[arg(long, value_enum, default_value_t = BlendKind::Iiwa, help_heading = METHOD)]
    pub(crate) blend_shape: BlendKind,

    /// Method of finding where a blend with a radius in mm begins and ends
    #[arg(long, value_enum, default_value_t = Search::FirstCrossing, help_heading = METHOD)]
    pub(crate) blend_search: Search,

    /// Samples per blend for --timing acceleration, 2 to 100000; more samples are more accurate and
    /// slower
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = whole::<u32, 2, 100_000>,
        help_heading = METHOD)]
    pub(crate) samples: u32,

    /// Also write the trajectory of a single program as a CSV table: time, motion, joint positions,
    /// velocities and accelerations, TCP, torques
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) csv: Option<PathBuf>,

    /// Write all digits of the numbers in the CSV table. By default, they are rounded to 1e-9 of
    /// their units (s, rad, m, Nm)
    #[arg(long, requires = "csv")]
    pub(crate) exact: bool,

    /// Also write the trajectory of a single program as an Apache Parquet file
    #[arg(long, value_name = "FILE.parquet")]
    pub(crate) parquet: Option<PathBuf>,

    /// Joint states per second in output files, 0.1 to 100000
    #[arg(long, value_name = "HZ", default_value_t = 250.0, value_parser = rate)]
    pub(crate) rate: f64,

    /// Largest MCAP file to write, such as 500MB or 5GB (CSV tables may be three times as large).
    /// The size is estimated before writing, and a larger file is refused: the trajectory of a
    /// program that lasts for months would fill any disk
    #[arg(long, value_name = "SIZE", default_value = "1GB")]
    pub(crate) max_file_size: ByteSize,

    #[command(flatten)]
    pub(crate) answering: Box<Answering>,

    /// Built-in model or robot profile, instead of the program's
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Gate: exit with code 3 if a cycle time is above this, in s
    #[arg(long, value_name = "S", value_parser = at_least_0)]
    pub(crate) max_cycle_time: Option<f64>,

    /// Gate: exit with code 3 if a joint torque (link side) is above this, in % of the robot's
    /// limit
    #[arg(long, value_name = "P", value_parser = at_least_0)]
    pub(crate) max_torque_percent: Option<f64>,

    /// Scene with obstacles in JSON (`iiwasim schema scene`), to print the clearance of the arm
    #[arg(long, value_name = "SCENE.json", env = "IIWASIM_SCENE", hide_env = true)]
    pub(crate) scene: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) arm: Urdf,

    /// Gate: exit with code 3 if the clearance to an obstacle of the scene is below this, in mm
    #[arg(long, value_name = "MM", value_parser = at_least_0)]
    pub(crate) min_clearance: Option<f64>,

    /// First time stamp in the file, from 1970 to 2037 [default: 2020-01-01T00:00:00Z]
    #[arg(long, value_name = "TIME", value_parser = epoch)]
    pub(crate) epoch: Option<Duration>,

    #[command(flatten)]
    pub(crate) ros: RosNaming,

    /// Also print the assumptions about the controller that affect the cycle time; the output of
    /// --json always contains them, under the key `rests_on`
    #[arg(long)]
    pub(crate) assumptions: bool,

    /// Also print the solver's iterations for a single program, on standard error (not with
    /// --timing acceleration). PTP motions without blends need no iterations
    #[arg(long, help_heading = METHOD)]
    pub(crate) trace: bool,

    /// Also draw the flange path and the joint speeds of a single program as a picture
    #[arg(long, value_name = "FILE.svg|png|pdf")]
    pub(crate) picture: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Timing {
    /// Velocity and acceleration (Larsen 2019)
    Acceleration,
    /// Velocity, acceleration and jerk
    Jerk,
    /// As recorded on a real robot. PTP motions between two stops have the speed profile that was
    /// fitted to recordings; splines between two stops follow a speed model that was fitted to
    /// recordings, and can exceed acceleration and jerk limits. All other motions are planned as
    /// with `jerk`, but with the soft starts and stops of recorded motions (an assumption: no
    /// motions of these other kinds have been recorded)
    Sunrise,
}

impl Timing {
    /// Returns the timing of a plan. `sweep` has the options of the forward and backward pass,
    /// which only `acceleration` uses.
    pub(crate) fn with(self, sweep: SweepOptions) -> iiwa_traj::Timing {
        match self {
            Self::Acceleration => iiwa_traj::Timing::Acceleration(sweep),
            Self::Jerk => iiwa_traj::Timing::jerk_limited(),
            Self::Sunrise => iiwa_traj::Timing::default(),
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum BlendKind {
    /// The blend of the LBR iiwa (Larsen 2019, Eq. 39)
    Iiwa,
    /// Blend polynomial without the shape term kappa (Eq. 13)
    Alpha,
    /// Blend polynomial with the smallest mean acceleration (Eq. 26)
    MinAcceleration,
    /// Circle in joint space (Eq. 32); only with --timing acceleration
    Circle,
}

impl From<BlendKind> for BlendShape {
    fn from(shape: BlendKind) -> Self {
        match shape {
            BlendKind::Iiwa => Self::Iiwa,
            BlendKind::Alpha => Self::Alpha(Continuity::Second),
            BlendKind::MinAcceleration => Self::MinAcceleration,
            BlendKind::Circle => Self::Circle,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Search {
    /// Search along the motion, backwards from its target, for the first point whose distance from
    /// the target is the blend radius; never misses a point
    FirstCrossing,
    /// Bisection (Larsen 2019, Algorithm 1)
    #[value(name = "algorithm-1")]
    Algorithm1,
    /// Steps of 0.001 of the motion's length; may miss the first point at the blend radius (Larsen
    /// 2019, Algorithm 2)
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
