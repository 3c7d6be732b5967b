//! `iiwasim status`.

use std::time::{Duration, Instant};

use iiwa_files::interrupt;
use iiwa_link::{
    Published, Stream,
    message::{Degrees, DriveState},
};

use crate::{args::Status, connection, failure::Failure, output};

/// Prints the state of the robot, once or continuously.
pub(crate) fn run(options: &Status) -> Result<(), Failure> {
    let status = connection::client(&options.drive)?
        .state()
        .map_err(|error| connection::failed("cannot ask for the state", &error))?;
    if options.watch {
        return watch(options, status.state);
    }
    if options.json {
        return output::print_json(&status);
    }
    output::print(&status.text())
}

/// Follows the robot until an interrupt.
fn watch(options: &Status, mut state: DriveState) -> Result<(), Failure> {
    const EVERY: Duration = Duration::from_millis(200);
    const SILENT: Duration = Duration::from_secs(1);
    let mut stream =
        Stream::new(&connection::remote(&options.drive.keys)?, &options.stream.to_string())
            .map_err(|error| connection::link_failure(&error))?;
    output::catch_interrupts();
    let mut shown = None::<Instant>;
    if !options.json {
        let joints = ["A1", "A2", "A3", "A4", "A5", "A6", "A7"].map(|name| format!("{name:>8}"));
        output::print(&format!("{:>10}    {:<18}{}\n", "time", "state", joints.join(" ")))?;
    }
    while !interrupt::has_come() {
        let pause = |length| shown.is_none_or(|shown| shown.elapsed() >= length);
        let next = stream.next(EVERY).map_err(|error| connection::link_failure(&error))?;
        let line = match next {
            Some(message) if options.json => output::json_line(&message)?,
            Some(Published::State { state: now, .. }) => {
                state = now;
                continue;
            }
            Some(Published::Joints { t_s, joints_rad }) if pause(EVERY) => {
                format!("{t_s:10.3} s  {state:<18}{}\n", Degrees(&joints_rad))
            }
            None if pause(SILENT) && !options.json => {
                "nothing is published: the drive receives nothing from the controller\n".to_owned()
            }
            _ => continue,
        };
        shown = Some(Instant::now());
        if !output::print_if_read(&line)? {
            break;
        }
    }
    Ok(())
}
