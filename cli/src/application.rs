//! Programs of Sunrise applications, with or without the feature `sunrise`.

use std::path::Path;

use crate::{
    args::Answering,
    failure::Failure,
    input::{self, Input},
};

/// Reads a program, or imports the program of an application if `path` is the folder of a Sunrise
/// project; `robot` overrides the robot that either names.
pub(crate) fn program_or_application(
    path: &Path,
    answering: &Answering,
    robot: Option<&str>,
) -> Result<Input, Failure> {
    if path.is_dir() { application(path, answering, robot) } else { input::program(path, robot) }
}

/// Imports the program of a Sunrise application from the folder of its project; `robot` overrides
/// the project's own robot.
pub(crate) fn application(
    project: &Path,
    answering: &Answering,
    robot: Option<&str>,
) -> Result<Input, Failure> {
    #[cfg(feature = "sunrise")]
    return crate::sunrise::program(project, answering, robot);
    #[cfg(not(feature = "sunrise"))]
    {
        let _ = (project, answering, robot);
        Err(crate::features::SUNRISE.missing("the application of a Sunrise project"))
    }
}
