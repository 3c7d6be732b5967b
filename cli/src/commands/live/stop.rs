//! `iiwasim stop`.

use crate::{args::Stop, connection, failure::Failure, output};

/// Stops the robot.
pub(crate) fn run(options: &Stop) -> Result<(), Failure> {
    connection::client(&options.drive)?
        .stop()
        .map_err(|error| connection::failed("the robot was not stopped", &error))?;
    output::print("The robot is at rest\n")
}
