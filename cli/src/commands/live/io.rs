//! `iiwasim io`.

use iiwa_json::printable;
use iiwa_report::{fitted, table};

use crate::{
    args::{DriveAddress, IoAction},
    connection,
    failure::Failure,
    output, terminal,
};

/// Prints all inputs and outputs, or the value of one; for `set` the new value.
pub(crate) fn run(action: &IoAction) -> Result<(), Failure> {
    let value = match action {
        IoAction::List { json, drive } => return list(drive, *json),
        IoAction::Get { name, drive } => connection::client(drive)?
            .get_io(name)
            .map_err(|error| connection::failed("cannot read it", &error)),
        IoAction::Set { name, value, drive } => connection::client(drive)?
            .set_io(name, *value)
            .map_err(|error| connection::failed("cannot set it", &error)),
    };
    output::print(&format!("{}\n", value?))
}

fn list(drive: &DriveAddress, json: bool) -> Result<(), Failure> {
    let signals = connection::client(drive)?
        .list_io()
        .map_err(|error| connection::failed("cannot read inputs and outputs", &error))?;
    if json {
        return output::print_json(&signals);
    }
    let mut table = table(&["name", "direction", "value"]);
    for signal in &signals {
        let (name, direction) = (printable(&signal.name), signal.direction.name().to_owned());
        table.add_row([name, direction, signal.value.to_string()]);
    }
    output::print(&format!("{}\n", fitted(table, terminal::width())))
}
