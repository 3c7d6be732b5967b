//! `iiwasim export`.

use std::path::PathBuf;

use clap::Args;

/// Export a motion program as a KUKA Sunrise project with a Java application.
///
/// FOLDER/src/application contains the application, FOLDER/RoboticsAPI.data.xml its frames and tool
/// templates with load data. Targets, limits and blends are exactly those of the program; unnamed
/// frames get names, such as P7 for motion 7. Motions that blend into the next one are sent by
/// moveAsync, all others by move. Tools and workpieces are attached and detached; a tool that holds
/// a workpiece is a template of its own.
///
/// Motions that Sunrise cannot express are refused, with motion and key. Notes list the settings
/// that an application does not control: mounting, T1, torque limits. The arm must be at the
/// program's start before the application runs: the class comment states the start, and the process
/// data contain the start and the robot.
#[derive(Args, Debug)]
pub(crate) struct Export {
    /// Write a project of KUKA Sunrise
    #[arg(long, required = true)]
    pub(crate) sunrise: bool,

    /// Motion program in JSON, or `-` for standard input
    #[arg(value_name = "PROGRAM")]
    pub(crate) program: PathBuf,

    /// Project folder, written atomically
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,

    /// Replace the files of an existing project; other files are kept
    #[arg(long)]
    pub(crate) overwrite: bool,

    /// Class name of the application [default: from the program's name]
    #[arg(long, value_name = "CLASS")]
    pub(crate) name: Option<String>,

    /// Built-in model or robot profile [default: the program's]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Print what was written as a JSON object
    #[arg(long)]
    pub(crate) json: bool,
}
