//! `iiwasim place`.

use std::path::PathBuf;

use clap::Args;
use iiwa_optimise::PlaceGrid;

use super::{SceneOptions, SearchInput, SearchOutput};
use crate::args::values::number;

/// Find the robot base position at which a program is fastest.
///
/// The robot's base is moved from its present place to the places of a grid, and the program is
/// planned exactly at each of them: by --x, --y and --z along the axes of the base, and by --yaw
/// about its z axis. Around the best place of the grid, the search continues in ever smaller steps.
/// A range has --steps places; one number instead of a range keeps that value.
///
/// Bases, frames and targets keep their places in the cell. Joint positions stay as they are: the
/// TCP is elsewhere in the cell there, and so is a line or a circle that begins there. Elbow angles
/// (E1) are not changed; `iiwasim optimise` improves them for the best place.
///
/// Places are checked for collisions only with --scene: its obstacles keep their places in the
/// cell, except those that move with the robot (--with-robot). At each place, every motion keeps
/// --min-clearance from the obstacles, and the arm from itself. A motion that has less in the
/// unchanged program may have less only between the same part of the arm and the same obstacle. The
/// foot and the shoulder are not checked against obstacles that they touch in the unchanged
/// program, and obstacles not against each other. The unchanged program must not touch an obstacle.
///
/// The table is a map of the cycle times by x and y, with z and yaw of the best place on the grid.
/// With --output, the program for the best place is written: its bases, frames and targets have
/// other coordinates, since they are stated relative to the robot.
#[derive(Args, Debug)]
pub(crate) struct PlaceRobot {
    #[command(flatten)]
    pub(crate) input: SearchInput,

    /// Range of shifts along x, in mm
    #[arg(long, value_name = "FROM:TO", default_value = "-100:100", allow_hyphen_values = true)]
    pub(crate) x: AxisRange,

    /// Range of shifts along y, in mm
    #[arg(long, value_name = "FROM:TO", default_value = "-100:100", allow_hyphen_values = true)]
    pub(crate) y: AxisRange,

    /// Range of shifts along z, in mm
    #[arg(long, value_name = "FROM:TO", default_value = "0", allow_hyphen_values = true)]
    pub(crate) z: AxisRange,

    /// Range of rotations about z, in deg
    #[arg(long, value_name = "FROM:TO", default_value = "0", allow_hyphen_values = true)]
    pub(crate) yaw: AxisRange,

    /// Number of places along each range
    #[arg(long, value_name = "COUNT", default_value_t = 5,
        value_parser = clap::value_parser!(u8).range(2..=100))]
    pub(crate) steps: u8,

    /// Draw the map as a picture, in colours from the slowest to the fastest place
    #[arg(long, value_name = "FILE.svg|png|pdf")]
    pub(crate) picture: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) around: SceneOptions,

    /// Obstacles of --scene that move with the robot base, by name, with commas between them
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) with_robot: Vec<String>,

    #[command(flatten)]
    pub(crate) found: SearchOutput,
}

/// A range `FROM:TO`, or a single value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisRange([f64; 2]);

impl AxisRange {
    /// Returns `steps` values along the range, multiplied by `unit`.
    pub(crate) fn values(self, steps: u8, unit: f64) -> Vec<f64> {
        PlaceGrid::axis(self.0, steps.into()).into_iter().map(|value| value * unit).collect()
    }
}

impl std::str::FromStr for AxisRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some((from, to)) = text.split_once(':') else {
            return number(text).map(|at| Self([at; 2]));
        };
        let range = [number(from)?, number(to)?];
        if range[0] <= range[1] { Ok(Self(range)) } else { Err(format!("`{text}` runs backwards")) }
    }
}
