//! A page that follows the robot.

use std::{net::SocketAddr, path::PathBuf};

use clap::Args;
use iiwa_link::security::Endpoint;

use super::{
    addresses::{DriveAddress, STREAM},
    values::at_least_0,
};

/// Follow the robot on a page: see it move, save positions, plan, send and replay programs.
///
/// The page is served to this machine only, at an address with a token that is printed first. It shows
/// the arm as the drive measures it, the drive's state, sensors, inputs and outputs, and, with --scene,
/// how near the arm is to what stands around it. A program is planned and shown before it may be sent,
/// and what the robot did is shown beside the plan. Positions that are saved become a program's targets.
///
/// The page is a client of the drive like any other: what it asks for goes through the drive's checks,
/// and through those of `iiwasim run`. Ctrl-C ends the twin; a run that it has begun is stopped on its
/// path.
#[derive(Args, Debug)]
pub(crate) struct Twin {
    /// Port of the page on this machine; 0 takes a free one
    #[arg(long, value_name = "PORT", default_value_t = 5562)]
    pub(crate) port: u16,

    /// Boxes and planes around the arm (`iiwasim schema scene` describes the file)
    #[arg(long, value_name = "SCENE.json")]
    pub(crate) scene: Option<PathBuf>,

    /// No program is sent that comes nearer to the scene, in mm
    #[arg(long, value_name = "MM", default_value_t = 10.0, value_parser = at_least_0)]
    pub(crate) min_clearance: f64,

    /// Folder for the programs that are sent, their plans and what the robot did, made if there is none
    /// [default: they are kept until the twin ends]
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,

    /// An input or output that is shown; may be given more than once [default: those of the media flange]
    #[arg(long = "io", value_name = "NAME")]
    pub(crate) io: Vec<String>,

    /// Publish the robot to Foxglove and Lichtblick, too, as a WebSocket server at this address:
    /// 127.0.0.1:8765 where none is given. It has no token, and no bound on how many connect: leave it out
    /// where programs run that are not trusted
    #[arg(long, value_name = "IP:PORT", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:8765")]
    pub(crate) foxglove: Option<SocketAddr>,

    /// Built-in model or robot profile
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    /// Where the drive publishes
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM)]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}
