//! `iiwasim import`.

use std::path::PathBuf;

use clap::Args;

use super::Answering;

/// Import a Sunrise project: an application as the motion program that it runs, or frames and tools.
///
/// From the folder of a project, an application is evaluated without a robot, and its program is written: each motion with
/// its file and line. The robot and its flange are those that the project states; if it states none, they are a question. Where
/// the application asks - dialogs, inputs, process data - it is answered by options or a file; every
/// question is listed with its answer. What cannot be known before the program runs is refused, with file, line and reason.
/// If the project has several applications, they are listed with what they need.
///
/// From RoboticsAPI.data.xml alone, from a project without Java, or with --frames, frames and tools are written for programs to
/// include. Frames that others are given in become bases, all others frames to go to, and those that were taught are both;
/// names are paths, as Table/P1. Templates of tools become tools: their default motion frame, or else their first one, is the
/// TCP, the others are tips, as in TOOL/TIP; loads come along. A program uses all of them with
/// `"include": "frames.json"`; `ik --program frames.json --frame Table/P1` looks at one. The tables show what was taken, what
/// was renamed, and what was not taken, with reasons. Each frame that was taught is checked: whether the robot reaches it with
/// its TCP of that time, with all joints within their limits, and with the status and the turn that were taught. If many are
/// not, the robot is another one, or has another flange.
#[derive(Args, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub(crate) struct Import {
    /// Sunrise project: its folder, or its file `RoboticsAPI.data.xml`; - reads standard input
    #[arg(value_name = "PROJECT")]
    pub(crate) project: PathBuf,

    #[command(flatten)]
    pub(crate) answering: Box<Answering>,

    /// Import frames and tools, although the project has applications
    #[arg(long, conflicts_with_all = ["application", "answer", "input", "data", "time", "tool", "answers", "start_deg", "fired", "flange_mm"])]
    pub(crate) frames: bool,

    /// Path of the program or of the frames [default: APPLICATION.json or frames.json]
    #[arg(short, long, value_name = "FILE.json")]
    pub(crate) output: Option<PathBuf>,

    /// Replace an existing program or file of frames, which may have been edited by hand
    #[arg(long, conflicts_with = "no_output")]
    pub(crate) overwrite: bool,

    /// Write a data file with all that the application needs and the project lacks, to fill in, and import nothing
    #[arg(long, value_name = "FILE.xml", conflicts_with_all = ["frames", "output", "no_output"])]
    pub(crate) write_data: Option<PathBuf>,

    /// Print the tables only, write no file
    #[arg(long, conflicts_with = "output")]
    pub(crate) no_output: bool,

    /// Built-in model or robot profile that runs the application, and on which frames are checked [default: the one that the
    /// project states]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Print the tables as a JSON object
    #[arg(long)]
    pub(crate) json: bool,
}
