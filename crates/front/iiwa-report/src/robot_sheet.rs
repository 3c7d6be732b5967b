//! Tables of robot geometry and limits.

use std::fmt::Write as _;

use iiwa_kin::Robot;

use crate::table::{fitted, table};

/// Formats geometry, limits, blends and masses of the robot as text, with the assumptions behind
/// them. Cells are wrapped to lines of at most `width` characters; see [`fitted`].
#[must_use]
pub fn robot_sheet(robot: &Robot, width: Option<u16>) -> String {
    let mut text = format!("{}\n\n", robot.name());

    text.push_str("Denavit-Hartenberg parameters\n");
    let mut dh = table(&["joint", "a mm", "alpha deg", "d mm"]);
    for (joint, row) in robot.dh().iter().enumerate() {
        dh.add_row([
            format!("A{}", joint + 1),
            rounded(row.a_m * 1e3),
            rounded(row.alpha_rad.to_degrees()),
            rounded(row.d_m * 1e3),
        ]);
    }
    let _ = writeln!(text, "{}\n", fitted(dh, width));
    let flange_mm = rounded(robot.lengths().flange_m * 1e3);
    let _ = writeln!(
        text,
        "d of A7 is the distance from the wrist to the flange face: {flange_mm} mm. For another \
         flange, such\nas the plain one of 126 mm, write \"flange_mm\": 126 in the program, or \
         use a profile with\n\"lengths_mm\": {{\"flange\": 126}}\n"
    );

    let limits = robot.limits();
    let mut rows = table(&["quantity", "unit", "A1", "A2", "A3", "A4", "A5", "A6", "A7"]);
    let mark = |quantity: &str| if robot.assumes(quantity) { " *" } else { "" };
    let degrees = |values: [f64; 7]| values.map(f64::to_degrees);
    for (quantity, unit, values) in [
        ("position from", "deg", degrees(limits.lower_rad)),
        ("position to", "deg", degrees(limits.upper_rad)),
        ("velocity", "deg/s", degrees(limits.velocity_rad_s)),
        ("acceleration", "deg/s^2", degrees(limits.acceleration_rad_s2)),
        ("jerk", "deg/s^3", degrees(limits.jerk_rad_s3)),
        ("torque", "Nm", limits.torque_nm),
    ] {
        let mut row = vec![format!("{quantity}{}", mark(quantity)), unit.to_owned()];
        let shown =
            |value: f64| if value.abs() >= 1e3 { format!("{value:.0}") } else { rounded(value) };
        row.extend(values.map(shown));
        rows.add_row(row);
    }
    let _ = writeln!(text, "{}\n", fitted(rows, width));

    let mut kappa = |quantity: &str, [c0, c1, c2]: &[f64; 3]| {
        let _ =
            writeln!(text, "kappa of {quantity}: {c0} + {c1} gamma + {c2} gamma^2, gamma in deg");
    };
    kappa("blends", robot.blend_kappa());
    if robot.tcp_blend_kappa() != robot.blend_kappa() {
        kappa("blends of TCP paths", robot.tcp_blend_kappa());
    }
    let _ = writeln!(
        text,
        "Standstill after a stop: {} s, or {} s if the program waits for the end of the motion",
        robot.settle_time_s(),
        robot.blocking_pause_s()
    );
    let _ = writeln!(
        text,
        "In T1, TCP and flange are limited to {} mm/s",
        rounded(1e3 * robot.t1_speed_m_s())
    );

    let masses = robot.link_mass_kg().map(rounded).join(", ");
    let _ = writeln!(text, "Link masses 0 to 7{}: {masses} kg", mark("masses"));
    for assumption in robot.assumptions() {
        let _ = writeln!(text, "* {} assumed: {}", assumption.quantity, assumption.basis);
    }
    text
}

/// Formats a number with at most three decimals, without trailing zeros.
#[must_use]
pub fn rounded(value: f64) -> String {
    let value = (value * 1000.0).round() / 1000.0;
    // Avoids a negative zero.
    format!("{}", value + 0.0)
}

/// Formats a table of the built-in robots. Cells are wrapped to lines of at most `width`
/// characters; see [`fitted`].
#[must_use]
pub fn robots_table(width: Option<u16>) -> String {
    let mut table = table(&["robot", "reach m", "flange m", "assumed"]);
    for robot in Robot::BUILT_IN.iter().filter_map(|name| Robot::built_in(name)) {
        let assumed: Vec<_> = robot.assumptions().iter().map(|a| a.quantity.as_str()).collect();
        let lengths = robot.lengths();
        table.add_row([
            robot.name().to_owned(),
            format!("{:.3}", lengths.upper_arm_m + lengths.forearm_m),
            format!("{:.3}", lengths.flange_m),
            assumed.join(", "),
        ]);
    }
    format!("{}\n", fitted(table, width))
}
