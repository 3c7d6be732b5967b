//! `iiwasim status`.

use std::fmt::Write as _;

use iiwa_link::message::Presence;

use crate::{args::Status, connection, failure::Failure, output};

/// Prints what the robot does now.
pub(crate) fn run(options: &Status) -> Result<(), Failure> {
    let status = connection::client(&options.drive)?
        .state()
        .map_err(|error| connection::failed("cannot ask for the state", &error))?;
    if options.json {
        return output::print_json(&status);
    }
    let mut text = format!("state          {}\n", status.state);
    match (status.joints_rad, status.t_s) {
        (Some(joints), Some(t_s)) => {
            let degrees = joints.map(|q| format!("{:.3}", q.to_degrees() + 0.0)).join(", ");
            let _ = writeln!(text, "joints         {degrees} deg, at {t_s:.3} s");
        }
        _ => text.push_str("joints         unknown: the controller has not been heard of\n"),
    }
    let fri = &status.fri;
    let _ = writeln!(
        text,
        "FRI            {}, quality {}; {} messages lost, {} late",
        fri.session, fri.quality, fri.lost, fri.late
    );
    let program = match status.robot_program {
        Presence::Connected => "connected",
        Presence::Silent => "silent",
    };
    let _ = writeln!(text, "robot program  {program}");
    output::print(&text)
}
