//! `iiwasim twin`.

use std::{net::SocketAddr, path::PathBuf};

use clap::Args;
use iiwa_link::security::Endpoint;

use super::{
    RosNaming, Urdf,
    addresses::{DriveAddress, STREAM},
    values::at_least_0,
};

/// Serve a page that shows the robot live: save positions, and plan, run and replay programs.
///
/// The page is served to this machine only, at an address with a token, which is printed at the
/// start. It shows the measured arm, the state of the drive, sensors, inputs and outputs, and, with
/// --scene, the clearance of the arm. A program is planned and shown before it can be run, and the
/// recording of the run is shown beside the plan. Saved positions are kept for later sessions, and
/// programs can be built from them.
///
/// The page is an ordinary client of the drive: the drive and the checks of `iiwasim run` validate
/// all requests. Ctrl-C ends the twin; a run that it has started is stopped on its path.
#[derive(Args, Debug)]
pub(crate) struct Twin {
    /// Port of the page on this machine; 0 for a free port
    #[arg(long, value_name = "PORT", default_value_t = 5562)]
    pub(crate) port: u16,

    /// Scene in JSON (`iiwasim schema scene`): obstacles and tool
    #[arg(long, value_name = "SCENE.json", env = "IIWASIM_SCENE", hide_env = true)]
    pub(crate) scene: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) arm: Urdf,

    /// Minimum clearance of programs, in mm
    #[arg(long, value_name = "MM", default_value_t = 10.0, value_parser = at_least_0)]
    pub(crate) min_clearance: f64,

    /// Folder for programs, plans and recordings, created if missing [default: a temporary folder,
    /// removed at the end]
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,

    /// File of saved positions, created on the first save [default: one file per robot in the
    /// user's data folder]
    #[arg(long, value_name = "FILE")]
    pub(crate) positions: Option<PathBuf>,

    /// Input or output to show; may be given more than once [default: those of the media flange]
    #[arg(long = "io", value_name = "NAME")]
    pub(crate) io: Vec<String>,

    /// Also publish the robot to Foxglove and Lichtblick at this WebSocket address, 127.0.0.1:8765
    /// without a value. No token is needed: any program on this machine can connect, up to 16
    #[arg(long, value_name = "IP:PORT", num_args = 0..=1, require_equals = true,
        default_missing_value = "127.0.0.1:8765")]
    pub(crate) foxglove: Option<SocketAddr>,

    #[command(flatten)]
    pub(crate) ros: RosNaming,

    /// Built-in model or robot profile
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    /// Address at which the drive sends joint positions and its state
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM, env = "IIWASIM_STREAM",
        hide_env = true)]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}
