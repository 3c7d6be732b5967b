//! Runs on the robot, through a drive: motion to the start, run, recording.

use iiwa_files::interrupt;
use iiwa_json::printable;
use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    ClientError, MAX_POINTS, StartOffset, Stream, TimedJoints,
    message::{Code, Conditions, DriveState, DriveStatus, Refusal, Request, RunLabel},
    security::Endpoint,
};
use iiwa_log::{Config, JointLog, WriteError};
use iiwa_plan::PlanOptions;
use iiwa_program::{IoEntry, Motion, MotionList, Ptp, Sources};
use iiwa_traj::Trajectory;
use iiwa_twin::{
    run_parts::{RunPart, execute_parts},
    runs::{DriveConnection, ExecutedRun, RunUpdate, execute, position},
};

use crate::{
    args::DriveAddress,
    connection,
    failure::{Failure, print_note},
    progress::Progress,
};

/// Connects to a drive and its stream.
pub(crate) fn connect(drive: &DriveAddress, stream: &Endpoint) -> Result<DriveConnection, Failure> {
    let remote = connection::remote(&drive.keys)?;
    let clients = [connection::client(drive)?, connection::client(drive)?];
    let stream = Stream::with_torques(&remote, &stream.to_string())
        .map_err(|error| connection::link_failure(&error))?;
    Ok(DriveConnection::of(clients, stream))
}

/// Returns advice for a rejected run of motions, to be appended to the rejection. The motions have
/// been planned before, so the drive, or the robot's program, does not support some of them.
pub(crate) fn hint(refusal: &Refusal) -> &'static str {
    match refusal.code {
        Code::BadRequest => {
            "; `iiwasim run --as-trajectory` sends the planned trajectory, which needs no planning \
             by the controller"
        }
        _ => "",
    }
}

/// Executes a run of planned duration, in s, with a progress bar, and stops it on an interrupt.
pub(crate) fn execute_with_progress(
    drive: &mut DriveConnection,
    request: &Request,
    planned_s: f64,
    progress: Progress,
) -> ExecutedRun {
    with_progress(planned_s, progress, |on_event| {
        execute(drive, request, interrupt::has_come, on_event)
    })
}

/// Executes the parts of a program with inputs and outputs, of planned duration, in s, with a
/// progress bar, and stops on an interrupt.
pub(crate) fn execute_parts_with_progress(
    drive: &mut DriveConnection,
    parts: &[RunPart],
    sources: &Sources,
    label: &RunLabel,
    planned_s: f64,
) -> ExecutedRun {
    with_progress(planned_s, Progress::of_run(), |on_event| {
        execute_parts(drive, parts, sources, label, interrupt::has_come, on_event)
    })
}

/// Shows the events of a run.
fn with_progress(
    planned_s: f64,
    mut progress: Progress,
    run: impl FnOnce(&mut dyn FnMut(RunUpdate<'_>)) -> ExecutedRun,
) -> ExecutedRun {
    let mut stops = 0;
    let run = run(&mut |event| match event {
        RunUpdate::Progress(t_s) => progress.show_time(t_s, planned_s),
        RunUpdate::Stopped(stopped) => {
            progress.aside(|| match stopped {
                _ if stops > 0 => {}
                Ok(()) => print_note("Interrupted: the robot is at rest\n"),
                Err(error) => print_note(&format!(
                    "The robot could not be stopped: {}\n",
                    printable(&error.to_string())
                )),
            });
            stops += 1;
        }
        RunUpdate::StreamError(error) => {
            progress.aside(|| print_note(&format!("The stream broke off: {error}\n")));
        }
        RunUpdate::Waiting(IoEntry { io, value, .. }) => {
            let io = printable(io);
            progress.aside(|| print_note(&format!("Waiting until {io} is {value}\n")));
        }
    });
    progress.clear();
    run
}

/// Explains why runs cannot start without [`position`].
pub(crate) fn unknown_position(status: &DriveStatus) -> String {
    let why =
        "the position of the robot is unknown: the drive receives nothing from the controller";
    match status.fri.unexpected_source {
        Some(from) => format!("{why}, but FRI messages from {from} (iiwasim drive --fri-cabinet)"),
        None => why.to_owned(),
    }
}

/// Ensures that the robot is at the start of a program.
///
/// The robot moves there only if `move_to_start` gives the velocity, in per cent of the limits.
pub(crate) fn go_to_start(
    drive: &mut DriveConnection,
    move_to_start: Option<f64>,
    start_rad: &Joints,
    robot: &Robot,
) -> Result<(), Failure> {
    let request =
        |error: ClientError| connection::failed("cannot ask for the position of the robot", &error);
    let status = drive.client().state().map_err(request)?;
    if status.state != DriveState::Idle {
        let message = "the robot is busy: it is running another program".to_owned();
        return Err(Failure::Run { message, cause: None });
    }
    let Some(joints_rad) = position(&status) else {
        return Err(Failure::Run { message: unknown_position(&status), cause: None });
    };
    if let Some(caution) = status.conditions.as_ref().and_then(Conditions::caution) {
        print_note(&format!("Warning: {caution}\n"));
    }
    let offset = StartOffset::new(&joints_rad, start_rad);
    if offset.is_within_tolerance() && (move_to_start.is_none() || offset.rad() < 1e-6) {
        return Ok(());
    }
    let Some(percent) = move_to_start else {
        return Err(Failure::Run {
            message: format!("{offset}; --move-to-start moves it there first"),
            cause: None,
        });
    };
    print_note("Moving to the start\n");
    let approach = Ptp::to(*start_rad).velocity(percent / 100.0);
    let approach = MotionList::from(vec![Motion::Ptp(approach)]);
    // The controller plans this motion by itself: the plan serves only to estimate the time.
    let plan = PlanOptions::default().plan(&approach.clone().starting_at(joints_rad), robot);
    let plan = plan.map_err(|error| {
        let message = "the robot cannot move to the start in a straight line in joint space";
        Failure::run(message, &error)
    })?;
    let request = Request::motions(approach).labelled(RunLabel::of_robot(robot));
    execute_with_progress(drive, &request, plan.cycle_time_s(), Progress::of_approach())
        .result
        .map(drop)
        .map_err(|error| connection::failed("the robot did not move to the start", &error))
}

/// Encodes a recording as MCAP, with the program that was run.
pub(crate) fn recording(
    log: &JointLog,
    file: Config,
    robot: &Robot,
    program: &str,
) -> Result<Vec<u8>, Failure> {
    log.to_mcap(file, robot, program).map_err(|error| {
        let message = match error {
            WriteError::EpochOutOfRange { .. } | WriteError::StampOutOfRange { .. } => {
                "cannot write the recording; --epoch gives it another time"
            }
            _ => "cannot write the recording",
        };
        Failure::run(message, &error)
    })
}

/// Samples the trajectory for the drive.
pub(crate) fn sampled(plan: &Trajectory) -> Result<TimedJoints, Failure> {
    iiwa_twin::runs::sampled(plan).ok_or_else(|| {
        Failure::input(format!(
            "the program takes {:.0} s: a drive takes trajectories of at most {MAX_POINTS} points. \
             Without --as-trajectory, the controller plans the motions itself",
            plan.cycle_time_s()
        ))
    })
}
