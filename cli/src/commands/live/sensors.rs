//! `iiwasim sensors`.

use iiwa_report::table;

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
    for (j, torque) in sensors.external_torque_nm.iter().enumerate() {
        let temperature = sensors.joint_temperature_c.map(|celsius| format!("{:.1}", celsius[j]));
        let temperature = temperature.unwrap_or_else(|| "-".to_owned());
        rows.add_row([format!("A{}", j + 1), temperature, format!("{torque:.2}")]);
    }
    let unknown = "The controller does not report the temperatures.\n";
    let note = if sensors.joint_temperature_c.is_none() { unknown } else { "" };
    output::print(&format!("{rows}\n{note}"))
}
