//! `iiwasim import`.

use std::path::PathBuf;

use clap::Args;

use super::Answering;

/// Import a Sunrise project: an application as a motion program, or frames and tools.
///
/// Given a project folder, an application is evaluated without a robot, and its motion program is
/// written, with file and line of each motion. The robot and its flange are read from the project;
/// if the project does not state them, `lbr_iiwa_7_r800` and 152 mm are assumed. Where the
/// application depends on something that the project does not contain (a dialog, an input, process
/// data, the robot), the import asks a question, which you answer by an option, such as --robot or
/// --flange-mm, or by an answers file. The output lists each question, and states whether its
/// answer is given, assumed or still open. If motions depend on values for which the import cannot
/// ask, because they are known only at run time (measured positions, for instance), the application
/// is rejected, with file, line and reason. If the project has several applications, they are
/// listed with their open questions.
///
/// With --frames, or if PROJECT has no Java code or is a RoboticsAPI.data.xml file, frames and
/// tools are written to a file that programs can include. Parent frames become bases, other frames
/// become targets, and taught parent frames become both; names are paths, such as Table/P1. Each
/// tool template becomes a tool with its load data. Its default motion frame, or else its first
/// frame, becomes the TCP; its other frames become further TCPs of the tool (tips), such as
/// TOOL/TIP. Programs include the file with `"include": "frames.json"`; `ik --program frames.json
/// --frame Table/P1` inspects a frame. The tables list imported, renamed and skipped entries, with
/// reasons. Each taught frame is checked: the robot must reach it with the taught TCP, status and
/// turn, within its joint limits. If many frames fail, the selected robot or flange is probably
/// wrong.
#[derive(Args, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub(crate) struct Import {
    /// Sunrise project: its folder, its file `RoboticsAPI.data.xml`, or `-` to read that file from
    /// standard input
    #[arg(value_name = "PROJECT")]
    pub(crate) project: PathBuf,

    #[command(flatten)]
    pub(crate) answering: Box<Answering>,

    /// Import frames and tools even if the project has applications
    #[arg(long, conflicts_with_all = ["application", "answer", "input", "data", "time", "tool",
        "answers", "start_deg", "fired", "flange_mm"])]
    pub(crate) frames: bool,

    /// Path of the program or frame file [default: APPLICATION.json or frames.json]
    #[arg(short, long, value_name = "FILE.json")]
    pub(crate) output: Option<PathBuf>,

    /// Replace an existing program or frame file, which may have been edited by hand
    #[arg(long, conflicts_with = "no_output")]
    pub(crate) overwrite: bool,

    /// Instead of importing, write a `RoboticsAPI.data.xml` with the entries that the application
    /// needs and the project lacks, for you to fill in
    #[arg(long, value_name = "FILE.xml", conflicts_with_all = ["frames", "output", "no_output"])]
    pub(crate) write_data: Option<PathBuf>,

    /// Print the tables only, write no file
    #[arg(long, conflicts_with = "output")]
    pub(crate) no_output: bool,

    /// Built-in model or robot profile for the application and for frame checks [default: the robot
    /// that the project states]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Print the tables as a JSON object
    #[arg(long)]
    pub(crate) json: bool,
}
