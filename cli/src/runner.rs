//! Runs on the robot, through a drive: the motion to the start, the run, its recording.

use std::{
    collections::BTreeMap,
    io::Cursor,
    iter, thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    Client, ClientError, LinkError, MAX_POINTS, Published, StartOffset, Stream, TimedJoints,
    Torques,
    message::{Code, DriveState, FriStatus, Refusal, Run as Measured, Samples, Status},
    security::Endpoint,
};
use iiwa_log::{Config, DEFAULT_EPOCH, JointLog, PlanOptions, Recorder, RecorderConfig};
use iiwa_program::{Motion, MotionList, Ptp};
use iiwa_traj::Trajectory;
use iiwa_view::printable;

use crate::{
    args::DriveAddress,
    connection,
    failure::{Failure, print_note},
    output,
    progress::Progress,
};

/// How long to wait for the stream before the run and the interrupt flag are checked.
const POLL: Duration = Duration::from_millis(50);

/// How long the stream is read on for the torques of a run's last samples.
const LAST_TORQUES: Duration = Duration::from_millis(500);

/// The connections to a drive.
pub(crate) struct DriveConnection {
    client: Client,
    /// Stops the run whose end the first client waits for.
    stopper: Client,
    stream: Stream,
}

impl DriveConnection {
    /// Of two clients of a drive, and its stream.
    pub(crate) fn of([client, stopper]: [Client; 2], stream: Stream) -> Self {
        Self { client, stopper, stream }
    }

    /// The client that starts runs, for other requests between them.
    pub(crate) fn client(&mut self) -> &mut Client {
        &mut self.client
    }

    /// Connects to a drive and its stream.
    pub(crate) fn new(drive: &DriveAddress, stream: &Endpoint) -> Result<Self, Failure> {
        let remote = connection::remote(&drive.keys)?;
        Ok(Self {
            client: connection::client(drive)?,
            stopper: connection::client(drive)?,
            stream: Stream::with_torques(&remote, &stream.to_string())
                .map_err(|error| connection::refused(&error))?,
        })
    }
}

/// What the drive is asked to run.
pub(crate) enum Task {
    Motions(MotionList),
    Trajectory(TimedJoints),
}

/// What to do about a run of motions that was refused, to be appended to the refusal. The motions have been planned before:
/// what is wrong with them is that the drive, or the robot's program, does not know some of them.
pub(crate) fn hint(refusal: &Refusal) -> &'static str {
    match refusal.code {
        Code::BadRequest => {
            "; `iiwasim run --as-trajectory` sends the planned trajectory, which needs no planning by the controller"
        }
        _ => "",
    }
}

/// Result of a run.
pub(crate) struct ExecutedRun {
    pub(crate) result: Result<Measured, ClientError>,
    /// The samples of the stream during the run.
    pub(crate) streamed: Samples,
    /// The torques of the stream, from before the run on.
    pub(crate) torques: Torques,
}

/// What happens during a run.
pub(crate) enum RunEvent<'a> {
    /// Time since the first sample, in s.
    Progress(f64),
    /// A stop was requested, with the answer of the drive.
    Stopped(&'a Result<(), ClientError>),
    /// The stream broke off.
    StreamError(&'a LinkError),
}

/// Runs a task that is planned to take so long, in s, with a progress bar, and stops it on an interrupt.
pub(crate) fn execute_with_progress(
    drive: &mut DriveConnection,
    task: Task,
    planned_s: f64,
    mut progress: Progress,
) -> ExecutedRun {
    let mut stops = 0;
    let run = execute(drive, task, output::interrupted, |event| match event {
        RunEvent::Progress(t_s) => progress.show_time(t_s, planned_s),
        RunEvent::Stopped(stopped) => {
            progress.aside(|| match stopped {
                _ if stops > 0 => {}
                Ok(()) => print_note("Interrupted: the robot stands\n"),
                Err(error) => print_note(&format!(
                    "The robot could not be stopped: {}\n",
                    printable(&error.to_string())
                )),
            });
            stops += 1;
        }
        RunEvent::StreamError(error) => {
            progress.aside(|| print_note(&format!("The stream broke off: {error}\n")));
        }
    });
    progress.clear();
    run
}

/// Runs a task, and stops it once `to_stop` returns true.
pub(crate) fn execute(
    drive: &mut DriveConnection,
    task: Task,
    to_stop: impl Fn() -> bool,
    on_event: impl FnMut(RunEvent<'_>),
) -> ExecutedRun {
    let DriveConnection { client, stopper, stream } = drive;
    thread::scope(|scope| {
        let running = scope.spawn(move || match task {
            Task::Motions(motions) => client.run_motions(motions, None),
            Task::Trajectory(trajectory) => client.run_trajectory(trajectory, None),
        });
        let (streamed, mut torques) =
            follow(stopper, stream, || running.is_finished(), to_stop, on_event);
        let result = running.join().unwrap_or_else(|_| {
            let what = "the thread of the run panicked; please report this".to_owned();
            Err(ClientError::InvalidReply { what })
        });
        if let Some(last_s) = last_stamp(&result) {
            catch_up(stream, last_s, &mut torques);
        }
        ExecutedRun { result, streamed, torques }
    })
}

/// Follows a run to its end.
fn follow(
    stopper: &mut Client,
    stream: &mut Stream,
    has_ended: impl Fn() -> bool,
    to_stop: impl Fn() -> bool,
    mut on_event: impl FnMut(RunEvent<'_>),
) -> (Samples, Torques) {
    let mut streamed = Samples::default();
    let mut torques = Torques::default();
    let mut runs = false;
    while !has_ended() {
        if to_stop() {
            // Repeated until the end: the run may not have started at the first one.
            on_event(RunEvent::Stopped(&stopper.stop()));
        }
        match stream.next(POLL) {
            Ok(Some(Published::Joints { t_s, joints_rad })) if runs => {
                streamed.t_s.push(t_s);
                streamed.joints_rad.push(joints_rad);
                on_event(RunEvent::Progress(t_s - streamed.t_s[0]));
            }
            // The first samples of a run are from before its state is published.
            Ok(Some(Published::Torques { t_s, measured_nm, .. })) => torques.keep(t_s, measured_nm),
            Ok(Some(Published::State { state, .. })) => runs = state != DriveState::Idle,
            Ok(_) => {}
            Err(error) => {
                on_event(RunEvent::StreamError(&error));
                thread::sleep(POLL);
            }
        }
    }
    (streamed, torques)
}

/// The stamp of a run's last sample.
fn last_stamp(result: &Result<Measured, ClientError>) -> Option<f64> {
    let run = match result {
        Ok(run) => run,
        Err(ClientError::Refused { run, .. }) => run.as_deref()?,
        Err(_) => return None,
    };
    run.samples.t_s.last().copied()
}

/// Reads on until the positions of `last_s` arrive, which come after the torques of that time.
fn catch_up(stream: &mut Stream, last_s: f64, torques: &mut Torques) {
    let since = Instant::now();
    while since.elapsed() < LAST_TORQUES {
        match stream.next(POLL) {
            Ok(Some(Published::Torques { t_s, measured_nm, .. })) => torques.keep(t_s, measured_nm),
            Ok(Some(Published::Joints { t_s, .. })) if t_s >= last_s => return,
            Ok(_) => {}
            Err(_) => return,
        }
    }
}

/// Why no run can start without [`position`].
pub(crate) const UNKNOWN_POSITION: &str =
    "the position of the robot is unknown: the drive receives nothing from the controller";

/// The joint positions in rad, unless they are outdated.
pub(crate) fn position(status: &Status) -> Option<Joints> {
    status.joints_rad.filter(|_| status.fri.session != FriStatus::SILENT)
}

/// Makes sure that the robot is at the start of a program.
///
/// It moves there only if `move_to_start` gives the velocity, in per cent of the limits.
pub(crate) fn go_to_start(
    drive: &mut DriveConnection,
    move_to_start: Option<f64>,
    start_rad: &Joints,
    robot: &Robot,
) -> Result<(), Failure> {
    let ask =
        |error: ClientError| connection::failed("cannot ask for the position of the robot", &error);
    let status = drive.client.state().map_err(ask)?;
    if status.state != DriveState::Idle {
        let what = "the robot is busy: it is running another program".to_owned();
        return Err(Failure::Run { what, cause: None });
    }
    let Some(joints_rad) = position(&status) else {
        return Err(Failure::Run { what: UNKNOWN_POSITION.to_owned(), cause: None });
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
    print_note("Moving to the start\n");
    let there = Ptp::to(*start_rad).velocity(percent / 100.0);
    let approach = MotionList::from(vec![Motion::Ptp(there)]);
    // The controller plans it by itself: this is for the time only.
    let plan = PlanOptions::default().plan(&approach.clone().starting_at(joints_rad), robot);
    let plan = plan.map_err(|error| {
        let what = "the robot cannot move to the start in a straight line in joint space";
        Failure::run(what, &error)
    })?;
    let task = Task::Motions(approach);
    execute_with_progress(drive, task, plan.cycle_time_s(), Progress::of_approach())
        .result
        .map(drop)
        .map_err(|error| connection::failed("the robot did not move to the start", &error))
}

/// The samples from the start of a run on, with their times since then, and how long the robot program says that it took;
/// and the torques of each sample, where they are known.
pub(crate) fn since_start(
    measured: &Measured,
    torques: &Torques,
) -> (JointLog, Vec<Option<Joints>>) {
    let Samples { t_s, joints_rad, .. } = &measured.samples;
    let from_s = measured.start_s.or(t_s.first().copied()).unwrap_or_default();
    // Stamps are rounded sums: the first sample may be just before the start.
    let first = t_s.partition_point(|t_s| t_s - from_s <= -1e-6);
    let times = t_s[first..].iter().map(|t_s| (t_s - from_s).max(0.0)).collect();
    let positions = joints_rad.get(first..).unwrap_or_default().to_vec();
    let mut log = JointLog::new(times, positions);
    log.cycle_time_s = measured.cycle_time_s;
    (log, torques.at(&t_s[first..]))
}

/// When the first sample of a log was taken whose last one has just arrived, since 1970.
pub(crate) fn began(log: &JointLog) -> Duration {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or(DEFAULT_EPOCH);
    let last_s = log.t_s.last().copied().unwrap_or_default();
    now.saturating_sub(Duration::try_from_secs_f64(last_s).unwrap_or_default())
}

/// A recording as MCAP, with the torques of its samples as far as there are any, and the program that was run.
pub(crate) fn recording(
    log: &JointLog,
    torques_nm: &[Option<Joints>],
    file: Config,
    robot: &Robot,
    program: &str,
) -> Result<Vec<u8>, Failure> {
    let refuse = |error: iiwa_log::WriteError| Failure::run("cannot write the recording", &error);
    let storage = Cursor::new(Vec::new());
    let config = RecorderConfig { file, ..RecorderConfig::default() };
    let mut recorder = Recorder::new(storage, robot, config).map_err(refuse)?;
    let torques_nm = torques_nm.iter().map(Option::as_ref).chain(iter::repeat(None));
    for ((t_s, q), torques_nm) in log.t_s.iter().zip(&log.q_rad).zip(torques_nm) {
        let Ok(t) = Duration::try_from_secs_f64(*t_s) else { continue };
        recorder.sample_with_torques(t, q, torques_nm).map_err(refuse)?;
    }
    let mut metadata = BTreeMap::from([("sample_count".to_owned(), log.t_s.len().to_string())]);
    if let Some(cycle_time_s) = log.cycle_time_s {
        metadata.insert("cycle_time_s".to_owned(), cycle_time_s.to_string());
    }
    let program = ("program.json", "application/json", program.as_bytes());
    let storage = recorder.finish(&metadata, &[program]).map_err(refuse)?;
    Ok(storage.into_inner())
}

/// Time from one point of a trajectory to the next, in s.
const STEP_S: f64 = 0.004;

/// The trajectory as it is sent: samples at a fixed step, and its end.
pub(crate) fn sampled(plan: &Trajectory) -> Result<TimedJoints, Failure> {
    let end_s = plan.cycle_time_s();
    let steps = (end_s / STEP_S).ceil();
    if steps >= MAX_POINTS as f64 {
        return Err(Failure::input(format!(
            "the program takes {end_s:.0} s, which is {steps:.0} points; a drive takes trajectories of \
             {MAX_POINTS}. Without --as-trajectory, the controller plans the motions itself"
        )));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let steps = steps as u32;
    let t_s: Vec<f64> = (0..steps)
        .map(|i| f64::from(i) * STEP_S)
        // No sample just before the end.
        .filter(|t_s| end_s - t_s > 1e-3 * STEP_S)
        .chain([end_s])
        .collect();
    let joints_rad = t_s.iter().map(|t_s| plan.at(*t_s).q).collect();
    Ok(TimedJoints { t_s, joints_rad })
}
