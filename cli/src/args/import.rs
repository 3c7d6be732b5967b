//! `iiwasim import`.

use std::path::PathBuf;

use clap::Args;

/// Import the frames and tools of a Sunrise project for programs to include.
///
/// Frames that others are given in become bases, all others frames to go to, and those that were taught are both; names
/// are paths, as Table/P1. Templates of tools become tools: their default motion frame, or else their first one, is the
/// TCP, the others are tips, as in TOOL/TIP; loads come along. A program uses all of them with
/// `"include": "frames.json"`; `ik --program frames.json --frame Table/P1` looks at one.
///
/// The tables show what was taken, what was renamed, and what was not taken, with reasons. Each frame that was taught is
/// checked: whether the robot reaches it with its TCP of that time, with all joints within their limits, and with the
/// status and the turn that were taught. If many are not, the robot is another one, or has another flange.
#[derive(Args, Debug)]
pub(crate) struct Import {
    /// Sunrise project: its folder, or its file `RoboticsAPI.data.xml`; - reads standard input
    #[arg(value_name = "PROJECT")]
    pub(crate) project: PathBuf,

    /// Path of the frames
    #[arg(short, long, value_name = "FRAMES.json", default_value = "frames.json")]
    pub(crate) output: PathBuf,

    /// Replace an existing file of frames, which may have been edited by hand
    #[arg(long, conflicts_with = "no_output")]
    pub(crate) overwrite: bool,

    /// Print the tables only, write no frames
    #[arg(long, conflicts_with = "output")]
    pub(crate) no_output: bool,

    /// Built-in model or robot profile on which the frames are checked [default: the LBR iiwa 7 R800]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Print the tables as a JSON object, with the joints at each frame
    #[arg(long)]
    pub(crate) json: bool,
}
