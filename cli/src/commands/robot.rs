//! `iiwasim robot`.

use std::{fmt::Write as _, path::Path};

use iiwa_kin::Robot;

use crate::{
    args,
    failure::Failure,
    input::{Text, find_robot},
    output,
    table::table,
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
    output::print(&model(&robot))
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

fn model(robot: &Robot) -> String {
    let mut text = format!("{}\n\n", robot.name());

    let mut dh = table(&["joint", "a mm", "alpha deg", "d mm"]);
    for (joint, row) in robot.dh().iter().enumerate() {
        dh.add_row([
            format!("A{}", joint + 1),
            round(row.a_m * 1e3),
            round(row.alpha_rad.to_degrees()),
            round(row.d_m * 1e3),
        ]);
    }
    let _ = writeln!(text, "{dh}\n");

    let limits = robot.limits();
    let mut rows = table(&["quantity", "unit", "A1", "A2", "A3", "A4", "A5", "A6", "A7"]);
    let mark = |what: &str| if robot.assumes(what) { " *" } else { "" };
    let degrees = |values: [f64; 7]| values.map(f64::to_degrees);
    for (what, unit, values) in [
        ("position +-", "deg", degrees(limits.position_rad)),
        ("velocity", "deg/s", degrees(limits.velocity_rad_s)),
        ("acceleration", "deg/s^2", degrees(limits.acceleration_rad_s2)),
        ("jerk", "deg/s^3", degrees(limits.jerk_rad_s3)),
        ("torque", "Nm", limits.torque_nm),
    ] {
        let mut row = vec![format!("{what}{}", mark(what)), unit.to_owned()];
        row.extend(values.map(round));
        rows.add_row(row);
    }
    let _ = writeln!(text, "{rows}\n");

    let [c0, c1, c2] = robot.blend_kappa();
    let _ = writeln!(text, "kappa of blends: {c0} + {c1} gamma + {c2} gamma^2, gamma in deg");
    let _ =
        writeln!(text, "Settles for {} s after a motion without a blend", robot.settle_time_s());

    let masses = robot.link_mass_kg().map(round).join(", ");
    let _ = writeln!(text, "Link masses 0 to 7{}: {masses} kg", mark("masses"));
    for assumption in robot.assumptions() {
        let _ = writeln!(text, "* {} assumed: {}", assumption.what, assumption.basis);
    }
    text
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
