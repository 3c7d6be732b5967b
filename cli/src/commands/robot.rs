//! `iiwasim robot`.

use std::{fmt::Write as _, path::Path};

use iiwa_kin::Robot;
use iiwa_view::{robot_sheet, table};

use crate::{
    args,
    failure::Failure,
    input::{Text, find_robot},
    output,
};

/// Prints a model, or the names of the built-in ones.
pub(crate) fn run(options: &args::Robot) -> Result<(), Failure> {
    let Some(name) = &options.model else { return output::print(&built_in()) };
    let robot = find_robot(name, Path::new("."))?;
    if options.json {
        return output::print(&format!("{}\n", robot.to_profile().trim_end()));
    }
    if options.urdf {
        return output::print(&format!("{}\n", robot.to_urdf().trim_end()));
    }
    if let Some(path) = &options.check {
        return check(&robot, path, options.tip.as_deref());
    }
    output::print(&robot_sheet(&robot))
}

fn built_in() -> String {
    let mut table = table(&["robot", "reach m", "flange m", "assumed"]);
    for robot in Robot::BUILT_IN.iter().filter_map(|name| Robot::built_in(name)) {
        let assumed: Vec<_> = robot.assumptions().iter().map(|a| a.what.as_str()).collect();
        let lengths = robot.lengths();
        table.add_row([
            robot.name().to_owned(),
            format!("{:.3}", lengths.upper_arm_m + lengths.forearm_m),
            format!("{:.3}", lengths.flange_m),
            assumed.join(", "),
        ]);
    }
    format!("{table}\n")
}

/// Three places at most, and no zeros behind the point.
fn round(value: f64) -> String {
    let value = (value * 1000.0).round() / 1000.0;
    // No negative zero.
    format!("{}", value + 0.0)
}

fn check(robot: &Robot, path: &Path, tip: Option<&str>) -> Result<(), Failure> {
    let Text { name, text } = Text::read(path)?;
    let report = robot
        .check_urdf(&text, tip)
        .map_err(|error| Failure::in_text(&error.what(), error.place(), &name, &text))?;
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
            "effort" => format!("{} Nm", round(value)),
            "velocity" => format!("{} deg/s", round(value.to_degrees())),
            _ => format!("{} deg", round(value.to_degrees())),
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
