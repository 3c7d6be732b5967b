//! Runs on the robot, through a drive: the way to the start, the run, what is written of it.

use std::{collections::BTreeMap, io::Cursor, thread, time::Duration};

use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    Client, ClientError, LinkError, Published, Stream, TimedJoints,
    message::{DriveState, FriStatus, Run as Measured, Samples},
    security::Endpoint,
};
use iiwa_log::{Recorder, RecorderConfig};
use iiwa_path::{Motion, Ptp};
use iiwa_view::printable;

use crate::{
    args::DriveAddress,
    connection,
    failure::{Failure, tell},
    output,
    progress::Progress,
    start::StartOffset,
};

/// How long the stream is waited for before the connection is looked at again.
const LOOK: Duration = Duration::from_millis(50);

/// The connections to a drive.
pub(crate) struct Line {
    client: Client,
    /// Stops the run that the client waits for.
    helper: Client,
    stream: Stream,
}

impl Line {
    /// Two clients of a drive, and what it publishes.
    pub(crate) fn of([client, helper]: [Client; 2], stream: Stream) -> Self {
        Self { client, helper, stream }
    }

    /// The client that runs are given to. Between them it may be asked for other things.
    pub(crate) fn client(&mut self) -> &mut Client {
        &mut self.client
    }

    /// Connects with a drive, and with where it publishes.
    pub(crate) fn new(drive: &DriveAddress, stream: &Endpoint) -> Result<Self, Failure> {
        let remote = connection::remote(&drive.keys)?;
        Ok(Self {
            client: connection::client(drive)?,
            helper: connection::client(drive)?,
            stream: Stream::new(&remote, &stream.to_string())
                .map_err(|error| connection::refused(&error))?,
        })
    }
}

/// What the drive is to do.
pub(crate) enum Task {
    Motions(Vec<Motion>),
    Trajectory(TimedJoints),
}

/// How a run went.
pub(crate) struct Watched {
    pub(crate) result: Result<Measured, ClientError>,
    /// What the stream brought meanwhile.
    pub(crate) seen: Samples,
}

/// What is heard of a run while it is under way.
pub(crate) enum Heard<'a> {
    /// It is so far, in s since the first that was heard of it.
    At(f64),
    /// It was told to stop, and that was taken, or not.
    Stopped(&'a Result<(), ClientError>),
    /// Nothing came over the stream.
    Silence(&'a LinkError),
}

/// Lets the drive run a task, shows how far it is, and stops it when it is interrupted.
pub(crate) fn watch(line: &mut Line, task: Task, planned_s: Option<f64>) -> Watched {
    let mut progress = Progress::of_run();
    let mut stops = 0;
    let watched = attend(line, task, output::interrupted, |heard| match heard {
        Heard::At(t_s) => {
            if let Some(planned_s) = planned_s {
                progress.show_share((t_s / planned_s).min(1.0));
            }
        }
        Heard::Stopped(stopped) => {
            progress.aside(|| match stopped {
                _ if stops > 0 => {}
                Ok(()) => tell("Interrupted: the robot stands\n"),
                Err(error) => tell(&format!(
                    "The robot could not be told to stop: {}\n",
                    printable(&error.to_string())
                )),
            });
            stops += 1;
        }
        Heard::Silence(error) => {
            progress.aside(|| tell(&format!("The stream broke off: {error}\n")));
        }
    });
    progress.clear();
    watched
}

/// Lets the drive run a task, and stops it once `to_stop` says so.
pub(crate) fn attend(
    line: &mut Line,
    task: Task,
    to_stop: impl Fn() -> bool,
    hear: impl FnMut(Heard<'_>),
) -> Watched {
    let Line { client, helper, stream } = line;
    thread::scope(|scope| {
        let running = scope.spawn(move || match task {
            Task::Motions(motions) => client.run_motions(motions, None),
            Task::Trajectory(trajectory) => client.run_trajectory(trajectory, None),
        });
        let seen = follow(helper, stream, || running.is_finished(), to_stop, hear);
        let result = running.join().unwrap_or_else(|_| {
            let what = "this program has failed; please report it".to_owned();
            Err(ClientError::InvalidReply { what })
        });
        Watched { result, seen }
    })
}

/// Follows a run until it has ended.
fn follow(
    helper: &mut Client,
    stream: &mut Stream,
    has_ended: impl Fn() -> bool,
    to_stop: impl Fn() -> bool,
    mut hear: impl FnMut(Heard<'_>),
) -> Samples {
    let mut seen = Samples::default();
    let mut runs = false;
    while !has_ended() {
        if to_stop() {
            // Again until it has ended: the first one may have come before it began.
            hear(Heard::Stopped(&helper.stop()));
        }
        match stream.next(LOOK) {
            Ok(Some(Published::Joints { t_s, joints_rad })) if runs => {
                seen.t_s.push(t_s);
                seen.joints_rad.push(joints_rad);
                hear(Heard::At(t_s - seen.t_s[0]));
            }
            Ok(Some(Published::State { state, .. })) => runs = state != DriveState::Idle,
            Ok(_) => {}
            Err(error) => {
                hear(Heard::Silence(&error));
                thread::sleep(LOOK);
            }
        }
    }
    seen
}

/// The robot has to be where the program starts.
///
/// `move_to_start` is the share of the limits of velocity, in per cent, at which it may move there.
pub(crate) fn go_to_start(
    line: &mut Line,
    move_to_start: Option<f64>,
    start_rad: &Joints,
) -> Result<(), Failure> {
    let ask = |error: ClientError| connection::failed("cannot ask where the robot is", &error);
    let status = line.client.state().map_err(ask)?;
    let Some(joints_rad) = status.joints_rad.filter(|_| status.fri.session != FriStatus::SILENT)
    else {
        return Err(Failure::Run {
            what: "it is not known where the robot is: the drive does not hear the controller"
                .to_owned(),
            cause: None,
        });
    };
    let offset = StartOffset::new(&joints_rad, start_rad);
    if offset.is_within_tolerance() && (move_to_start.is_none() || offset.rad() < 1e-6) {
        return Ok(());
    }
    let Some(percent) = move_to_start else {
        return Err(Failure::Run {
            what: format!("{offset}; --move-to-start moves it there first"),
            cause: None,
        });
    };
    tell("Moving to the start\n");
    let there = vec![Motion::Ptp(Ptp::to(*start_rad).velocity(percent / 100.0))];
    watch(line, Task::Motions(there), None)
        .result
        .map(drop)
        .map_err(|error| connection::failed("the robot did not move to the start", &error))
}

/// The samples from the start of a run on, each with its time since then.
pub(crate) fn since_start(measured: &Measured) -> Vec<(Duration, &Joints)> {
    let Samples { t_s, joints_rad, .. } = &measured.samples;
    let from_s = measured.start_s.or(t_s.first().copied()).unwrap_or_default();
    // Stamps are sums: the first sample may come out next to nothing before the start.
    let since = |t_s: f64| (t_s - from_s > -1e-6).then(|| (t_s - from_s).max(0.0));
    let time = |t_s: &f64| Duration::try_from_secs_f64(since(*t_s)?).ok();
    t_s.iter().zip(joints_rad).filter_map(|(t_s, q)| Some((time(t_s)?, q))).collect()
}

/// What the robot did, as MCAP, with the program that it ran.
pub(crate) fn recording(
    samples: &[(Duration, &Joints)],
    cycle_time_s: Option<f64>,
    robot: &Robot,
    program: &str,
) -> Result<Vec<u8>, Failure> {
    let refuse = |error: iiwa_log::WriteError| Failure::run("cannot write the recording", &error);
    let storage = Cursor::new(Vec::new());
    let mut recorder = Recorder::new(storage, robot, RecorderConfig::default()).map_err(refuse)?;
    for (t, q) in samples {
        recorder.sample(*t, q).map_err(refuse)?;
    }
    let mut metadata = BTreeMap::from([("sample_count".to_owned(), samples.len().to_string())]);
    if let Some(cycle_time_s) = cycle_time_s {
        metadata.insert("cycle_time_s".to_owned(), cycle_time_s.to_string());
    }
    let program = ("program.json", "application/json", program.as_bytes());
    let storage = recorder.finish(&metadata, &[program]).map_err(refuse)?;
    Ok(storage.into_inner())
}
