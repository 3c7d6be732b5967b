//! `iiwasim sensors`.

use iiwa_view::table;

use crate::{args::Sensors, connection, failure::Failure, output};

/// Prints the values of the robot's sensors.
pub(crate) fn run(options: &Sensors) -> Result<(), Failure> {
    let sensors = connection::client(&options.drive)?
        .read_sensors()
        .map_err(|error| connection::failed("cannot read the sensors", &error))?;
    if options.json {
        return output::print_json(&sensors);
    }
    let mut rows = table(&["joint", "temperature C", "external torque Nm"]);
    let values = sensors.joint_temperature_c.iter().zip(sensors.external_torque_nm);
    for (j, (temperature, torque)) in values.enumerate() {
        rows.add_row([format!("A{}", j + 1), format!("{temperature:.1}"), format!("{torque:.2}")]);
    }
    output::print(&format!("{rows}\n"))
}
