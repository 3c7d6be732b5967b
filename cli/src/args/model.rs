//! Commands about robot models and file formats.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{
    RosNaming,
    values::{number, seven, whole},
};

/// Forward kinematics: print the pose of the flange, or of a tool's TCP, at given joint positions.
#[derive(Args, Debug)]
pub(crate) struct Fk {
    #[command(flatten)]
    pub(crate) joints: Configuration,

    /// Built-in model or robot profile [default: the program's, or the LBR iiwa 7 R800]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    #[command(flatten)]
    pub(crate) place: ToolAndBase,

    /// Print one JSON object: `position_m`, `rotation` (three rows), `frame` (the same pose in mm
    /// and degrees with E1, status and turn, as in programs), `robot`
    #[arg(long)]
    pub(crate) json: bool,
}

/// Tool and base for poses.
#[derive(Args, Clone, Debug)]
pub(crate) struct ToolAndBase {
    /// Motion program that defines tools, bases and frames, or a file of tools, bases and frames
    /// for programs to include
    #[arg(long, value_name = "FILE.json")]
    pub(crate) program: Option<PathBuf>,

    /// Tool whose TCP is meant: `TOOL`, `TOOL/TIP`, or `flange` for the flange [default: the
    /// program's, or the flange without --program]
    #[arg(long, value_name = "NAME", requires = "program")]
    pub(crate) tool: Option<String>,

    /// Base in which poses are given, or `robot` for the robot's base [default: the program's, or
    /// the robot's base without --program]
    #[arg(long, value_name = "NAME", requires = "program")]
    pub(crate) base: Option<String>,
}

#[derive(Args, Debug)]
#[group(required = true, multiple = false)]
pub(crate) struct Configuration {
    /// Joint positions A1 to A7 in rad, such as 0,0.5,0,-1,0,0.7,0
    #[arg(long, value_name = "A1,...,A7", value_parser = seven, allow_hyphen_values = true)]
    joints_rad: Option<[f64; 7]>,

    /// Joint positions A1 to A7 in degrees, such as 0,30,0,-60,0,90,0
    #[arg(long, value_name = "A1,...,A7", value_parser = seven, allow_hyphen_values = true)]
    joints_deg: Option<[f64; 7]>,

    /// Read joint positions from standard input: a table with the columns `joint_1_deg` to
    /// `joint_7_deg` (or in rad; also `A1_deg` or `q1_deg`), with commas, semicolons, tabs or
    /// spaces, or one JSON object per line with `joints_deg`. Prints a table, or with --json one
    /// object per line
    #[arg(long)]
    pub(crate) stdin: bool,
}

impl Configuration {
    pub(crate) fn rad(&self) -> [f64; 7] {
        let from_deg = self.joints_deg.map(|deg| deg.map(f64::to_radians));
        // One of the two is required.
        self.joints_rad.or(from_deg).unwrap_or_default()
    }
}

/// Inverse kinematics: print the joint positions that bring the flange, or a tool's TCP, to a
/// frame.
#[derive(Args, Debug)]
pub(crate) struct Ik {
    #[arg(
        long,
        value_name = "JSON|NAME",
        required_unless_present = "stdin",
        default_value = "",
        hide_default_value = true,
        help = "Pose of the tool's TCP in the base (of the flange in the robot's base without \
            --program): a JSON object with x_mm, y_mm, z_mm, a_deg, b_deg, c_deg (or a_rad, ...), \
            and e1_deg, status and turn as on the robot; or the name of a frame of --program"
    )]
    pub(crate) frame: String,

    /// Read frames from standard input: a table with these keys as columns, with commas,
    /// semicolons, tabs or spaces, or one JSON object per line, also in the format of `iiwasim fk
    /// --json`. Prints a table, or with --json one object per line
    #[arg(long, conflicts_with = "frame")]
    pub(crate) stdin: bool,

    /// Position of joint A3 in degrees, instead of the frame's
    #[arg(long, value_name = "DEG", value_parser = number, allow_hyphen_values = true)]
    pub(crate) e1_deg: Option<f64>,

    /// Status (arm configuration), instead of the frame's: 1 if the wrist is behind A1, plus 2 if
    /// A4 is negative, plus 4 if A6 is negative
    #[arg(long, value_name = "0-7", value_parser = whole::<u8, 0, 7>)]
    pub(crate) status: Option<u8>,

    /// Joint positions A1 to A7 in degrees from which E1 and status are read, if they are given
    /// neither by options nor by the frame
    #[arg(long, value_name = "A1,...,A7", value_parser = seven, allow_hyphen_values = true)]
    pub(crate) near: Option<[f64; 7]>,

    /// Built-in model or robot profile [default: the program's, or the LBR iiwa 7 R800]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    #[command(flatten)]
    pub(crate) place: ToolAndBase,

    /// Print one JSON object: `joints_deg`, `joints_rad`, `frame`, `allowed_e1_deg` (ranges),
    /// `singularity`, `robot`
    #[arg(long)]
    pub(crate) json: bool,
}

/// Print a robot model: lengths, limits, masses. Without a name, list the built-in models.
#[derive(Args, Debug)]
pub(crate) struct Robot {
    /// Built-in model or robot profile
    #[arg(value_name = "NAME|FILE")]
    pub(crate) model: Option<String>,

    /// Print the differences from a built-in model as a robot profile, to edit and use with --robot
    #[arg(long, requires = "model", conflicts_with = "urdf")]
    pub(crate) json: bool,

    /// With --json, print all figures, also those of the built-in model; a profile states them as
    /// known instead of assumed
    #[arg(long, requires = "json")]
    pub(crate) all: bool,

    /// Print the model as a URDF with simple shapes
    #[arg(long, requires = "model")]
    pub(crate) urdf: bool,

    #[command(flatten)]
    pub(crate) ros: RosNaming,

    /// Check a URDF of the robot against the model; exit with code 3 if only its limits differ
    #[arg(long, value_name = "FILE.urdf", requires = "model",
        conflicts_with_all = ["urdf", "json"])]
    pub(crate) check: Option<PathBuf>,

    /// Link of that URDF at the flange, if it is not the last one
    #[arg(long, value_name = "LINK", requires = "check")]
    pub(crate) tip: Option<String>,
}

/// Print the JSON Schema of motion programs, frame files, robot profiles, scenes or bridge
/// messages.
#[derive(Args, Debug)]
pub(crate) struct Schema {
    /// The format
    #[arg(value_enum, default_value_t = OutputFormat::Program)]
    pub(crate) format: OutputFormat,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum OutputFormat {
    /// Motion program
    Program,
    /// Tools, bases and frames, which programs include
    Frames,
    /// Robot profile
    Profile,
    /// Scene: the obstacles around the arm
    Scene,
    /// Messages of `iiwasim bridge`
    Bridge,
}
