//! `iiwasim export`.

use std::path::PathBuf;

use clap::Args;

/// Export a motion program as a project for another system: an application in Java for KUKA Sunrise.
///
/// FOLDER/src/application has the application, FOLDER/RoboticsAPI.data.xml its frames and the templates of its tools with
/// their loads. Targets, limits and blends are the program's to the last bit; frames that the program gives where it
/// uses them get names, as P7 of motion 7. A motion that is blended into the next one is sent by moveAsync, all others by
/// move. What hangs on the flange is attached and detached; a tool that has picked something up is a template of its own.
///
/// What Sunrise has no call for is refused, with the motion and its key. What Java does not say while the arm moves as it
/// was planned is noted: the mount, T1, limits of torque. The start of the program is where the arm has to stand before;
/// it is in the comment of the class and, as the robot, in the process data of the project.
#[derive(Args, Debug)]
pub(crate) struct Export {
    /// Write a project of KUKA Sunrise
    #[arg(long, required = true)]
    pub(crate) sunrise: bool,

    /// Motion program in JSON; - reads standard input
    #[arg(value_name = "PROGRAM")]
    pub(crate) program: PathBuf,

    /// Folder of the project; it appears when it is complete
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,

    /// Replace the files of an existing project; its other files stay
    #[arg(long)]
    pub(crate) overwrite: bool,

    /// Name of the application's class [default: made of the program's name]
    #[arg(long, value_name = "CLASS")]
    pub(crate) name: Option<String>,

    /// Built-in model or robot profile [default: the program's]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Print what was written as a JSON object
    #[arg(long)]
    pub(crate) json: bool,
}
