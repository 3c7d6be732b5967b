//! The command line.

mod compare;
mod experiment;
mod identify;
mod link;
mod report;
mod twin;

use std::{path::PathBuf, time::Duration};

use bytesize::ByteSize;
use clap::{Args, Parser, Subcommand, ValueEnum};
use iiwa_path::{BlendSearch, BlendShape, Continuity};

pub(crate) use compare::Compare;
pub(crate) use experiment::{Experiment, ExperimentName};
pub(crate) use identify::Identify;
pub(crate) use link::{
    Cabinet, ClientKeys, Drive, DriveAddress, Io, IoAction, Keygen, Record, Run, Sensors,
    ServerKeys, Status, Stop,
};
pub(crate) use report::Report;
pub(crate) use twin::Twin;

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  it failed while running (a file could not be written, it was interrupted)
  2  wrong usage or invalid input
  3  done, but a gate such as --max-cycle-time was not met, or of many programs some failed";

/// Motion simulator for the KUKA LBR iiwa: which path will the arm take through a motion program,
/// and how long will it take?
#[derive(Debug, Parser)]
#[command(name = "iiwasim", version, after_help = EXIT_CODES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Plan(Plan),
    Run(Run),
    Compare(Compare),
    Report(Report),
    Identify(Identify),
    Experiment(Experiment),
    Twin(Twin),
    Record(Record),
    Status(Status),
    Stop(Stop),
    Io(Io),
    Sensors(Sensors),
    Drive(Drive),
    Cabinet(Cabinet),
    Keygen(Keygen),
    Fk(Fk),
    Robot(Robot),
    Schema(Schema),
}

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
#[command(after_help = EXIT_CODES)]
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
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub(crate) max_cycle_time: Option<f64>,

    /// Scene in JSON (`iiwasim schema scene` describes it): tells how near the arm comes to its obstacles
    #[arg(long, value_name = "SCENE.json")]
    pub(crate) scene: Option<PathBuf>,

    /// Exit with code 3 if the arm comes nearer to an obstacle of the scene, in mm, or touches one: a gate
    /// for CI
    #[arg(long, value_name = "MM", value_parser = millimetres, requires = "scene")]
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

/// Forward kinematics: print where the flange is at given joint angles.
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct Fk {
    #[command(flatten)]
    pub(crate) joints: Joints,

    /// Built-in model or robot profile
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    /// Print one JSON object: `position_m`, `rotation` (three rows), `robot`
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
#[group(required = true, multiple = false)]
pub(crate) struct Joints {
    /// Joints A1 to A7 in rad, as 0,0.5,0,-1,0,0.7,0
    #[arg(long, value_name = "A1,...,A7", value_parser = seven, allow_hyphen_values = true)]
    joints_rad: Option<[f64; 7]>,

    /// Joints A1 to A7 in degrees, as 0,30,0,-60,0,90,0
    #[arg(long, value_name = "A1,...,A7", value_parser = seven, allow_hyphen_values = true)]
    joints_deg: Option<[f64; 7]>,
}

impl Joints {
    pub(crate) fn rad(&self) -> [f64; 7] {
        let from_deg = self.joints_deg.map(|deg| deg.map(f64::to_radians));
        // One of the two is required.
        self.joints_rad.or(from_deg).unwrap_or_default()
    }
}

/// Print a robot model: lengths, limits, masses; without a name, the built-in models.
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct Robot {
    /// Built-in model or robot profile
    #[arg(value_name = "NAME|FILE")]
    pub(crate) model: Option<String>,

    /// Print the model as a robot profile, to be changed and used with --robot
    #[arg(long, requires = "model", conflicts_with = "urdf")]
    pub(crate) json: bool,

    /// Print the model as a URDF with simple shapes
    #[arg(long, requires = "model")]
    pub(crate) urdf: bool,

    /// Check a URDF of the robot against the model; exit with code 3 if only its limits differ
    #[arg(long, value_name = "FILE.urdf", requires = "model", conflicts_with_all = ["urdf", "json"])]
    pub(crate) check: Option<PathBuf>,

    /// Link of that URDF at the flange, if it is not the last one
    #[arg(long, value_name = "LINK", requires = "check")]
    pub(crate) tip: Option<String>,
}

/// Print the JSON Schema of motion programs, robot profiles or scenes, for editors and checkers.
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct Schema {
    /// Of which format
    #[arg(value_enum, default_value_t = Format::Program)]
    pub(crate) format: Format,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Format {
    /// Motion program
    Program,
    /// Robot profile
    Profile,
    /// Scene: the obstacles around the arm
    Scene,
}

fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("`{text}` is not finite")) }
}

fn seven(text: &str) -> Result<[f64; 7], String> {
    let values = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    let count = values.len();
    values.try_into().map_err(|_| format!("{count} numbers where seven joints are needed"))
}

fn rate(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    let range = 0.1..=100_000.0;
    if range.contains(&value) { Ok(value) } else { Err("a rate is from 0.1 to 100000 Hz".into()) }
}

fn seconds(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value >= 0.0 { Ok(value) } else { Err("a time cannot be negative".into()) }
}

fn millimetres(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value >= 0.0 { Ok(value) } else { Err("a distance cannot be negative".into()) }
}

fn epoch(text: &str) -> Result<Duration, String> {
    // Messages count seconds in 31 bits; a year is left for what the program does.
    let last = Duration::from_secs(2_145_916_799);
    let instant = humantime::parse_rfc3339(text)
        .ok()
        .and_then(|instant| instant.duration_since(std::time::UNIX_EPOCH).ok());
    instant
        .filter(|epoch| *epoch <= last)
        .ok_or_else(|| "an instant from 1970 to 2037 is needed, as 2020-01-01T00:00:00Z".to_owned())
}
