//! `iiwasim robot`.

use std::{fmt::Write as _, path::Path};

use iiwa_kin::Robot;
use iiwa_report::{robot_sheet, robots_table, rounded};

use crate::{
    args,
    failure::Failure,
    input::{FileText, find_robot},
    output, terminal,
};

/// Prints a model, or the names of the built-in models.
pub(crate) fn run(options: &args::Robot) -> Result<(), Failure> {
    let Some(name) = &options.model else { return output::print(&robots_table(terminal::width())) };
    let robot = find_robot(name)?;
    if options.json {
        let profile = if options.all { robot.to_full_profile() } else { robot.to_profile() };
        return output::print(&format!("{}\n", profile.trim_end()));
    }
    if options.urdf {
        let urdf = robot.to_urdf_with_names(&options.ros.names());
        return output::print(&format!("{}\n", urdf.trim_end()));
    }
    if let Some(path) = &options.check {
        return check(&robot, path, options.tip.as_deref());
    }
    output::print(&robot_sheet(&robot, terminal::width()))
}

fn check(robot: &Robot, path: &Path, tip: Option<&str>) -> Result<(), Failure> {
    let FileText { name, text } = FileText::read(path)?;
    let report = robot
        .check_urdf(&text, tip)
        .map_err(|error| Failure::in_text(&error.message(), error.place(), &name, &text))?;
    let mut out = format!(
        "The axes and the flange of {name} agree with {}: {} to {}, joints {}\n\
         Largest deviation over {} poses: {:.6} mm, {:.6} deg\n",
        robot.name(),
        report.base,
        report.tip,
        report.joints.join(", "),
        report.poses,
        report.position_deviation_m * 1e3,
        report.rotation_deviation_rad.to_degrees()
    );
    for difference in &report.limits {
        let show = |value: f64| match difference.limit {
            "effort" => format!("{} Nm", rounded(value)),
            "velocity" => format!("{} deg/s", rounded(value.to_degrees())),
            _ => format!("{} deg", rounded(value.to_degrees())),
        };
        let _ = writeln!(
            out,
            "Joint {}: {} is {} in the URDF and {} in the model",
            difference.joint,
            difference.limit,
            difference.urdf.map_or_else(|| "missing".to_owned(), show),
            show(difference.model)
        );
    }
    output::print(&out)?;
    match report.limits.len() {
        0 => Ok(()),
        count => Err(Failure::Gate(format!("{count} limits of {name} differ from the model's"))),
    }
}
