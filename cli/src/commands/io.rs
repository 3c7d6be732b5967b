//! `iiwasim io`.

use crate::{args::IoAction, connection, failure::Failure, output};

/// Prints the value of an input or output, for `set` the new one.
pub(crate) fn run(action: &IoAction) -> Result<(), Failure> {
    let value = match action {
        IoAction::Get { name, drive } => connection::client(drive)?
            .get_io(name)
            .map_err(|error| connection::failed("cannot read it", &error)),
        IoAction::Set { name, value, drive } => connection::client(drive)?
            .set_io(name, *value)
            .map_err(|error| connection::failed("cannot set it", &error)),
    };
    output::print(&format!("{}\n", value?))
}
