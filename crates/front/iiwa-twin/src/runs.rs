//! Runs on the robot, through a drive, and their recordings.

use std::{
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    Client, ClientError, LinkError, Published, Stream, Torques,
    message::{
        BindingLimit, DriveState, DriveStatus, FriStatus, MeasuredPositions, Request,
        Run as Measured, RunLabel, RunPlan, TimedBy,
    },
};
use iiwa_log::{CycleClock, DEFAULT_EPOCH, JointLog};
use iiwa_plan::PlanFigures;
use iiwa_program::IoEntry;

pub use crate::sampled::sampled;

/// Timeout of the stream before the run and the interrupt flag are checked.
pub(crate) const POLL: Duration = Duration::from_millis(50);

/// Time limit for reading the torques of a run's last samples from the stream.
const LAST_TORQUES: Duration = Duration::from_millis(500);

/// Connections to a drive.
pub struct DriveConnection {
    client: Client,
    /// Client that stops the run while the first client waits for its end.
    stopper: Client,
    stream: Stream,
}

impl DriveConnection {
    /// Combines two clients of a drive, and its stream.
    #[must_use]
    pub fn of([client, stopper]: [Client; 2], stream: Stream) -> Self {
        Self { client, stopper, stream }
    }

    /// Client that starts runs, for other requests between them.
    pub fn client(&mut self) -> &mut Client {
        &mut self.client
    }

    /// Stream of the drive.
    pub(crate) fn stream(&mut self) -> &mut Stream {
        &mut self.stream
    }
}

/// Maximum number of motions whose limits are in a label.
const LABELLED_MOTIONS: usize = 100;

/// Returns the label of a planned run: the name of the program, its robot, its cycle time, and the
/// active limits of its motions.
#[must_use]
pub fn label(program: &str, figures: &PlanFigures, robot: &Robot) -> RunLabel {
    let limits = figures.motions.iter().filter_map(|motion| {
        let longest = motion.limits.first()?;
        Some(BindingLimit {
            motion: motion.index,
            joint: longest.limit.joint,
            kind: longest.limit.kind.clone().into_owned(),
            share: longest.share,
        })
    });
    let plan = RunPlan {
        cycle_time_s: figures.cycle_time_s,
        limited_by: limits.take(LABELLED_MOTIONS).collect(),
    };
    let program = program.chars().take(200).collect();
    RunLabel { program: Some(program), plan: Some(plan), ..RunLabel::of_robot(robot) }
}

/// Result of a run.
#[derive(Debug)]
pub struct ExecutedRun {
    /// Run as the drive reports it, or the reason for its failure.
    pub result: Result<Measured, ClientError>,
    /// Samples of the stream during the run.
    pub streamed: MeasuredPositions,
    /// Torques of the stream, since before the run.
    pub torques: Torques,
}

/// Event during a run.
#[derive(Debug)]
pub enum RunUpdate<'a> {
    /// Progress: time since the first sample, in s.
    Progress(f64),
    /// A stop was requested, with the answer of the drive.
    Stopped(&'a Result<(), ClientError>),
    /// The stream failed.
    StreamError(&'a LinkError),
    /// The program waits for an input.
    Waiting(&'a IoEntry),
}

/// Executes a request, and stops the run once `to_stop` returns true.
pub fn execute(
    drive: &mut DriveConnection,
    request: &Request,
    to_stop: impl Fn() -> bool,
    on_event: impl FnMut(RunUpdate<'_>),
) -> ExecutedRun {
    let DriveConnection { client, stopper, stream } = drive;
    thread::scope(|scope| {
        let running = scope.spawn(move || client.run(request, None));
        let (streamed, mut torques) =
            follow(stopper, stream, || running.is_finished(), to_stop, on_event);
        let result = running.join().unwrap_or_else(|_| {
            let message = "the thread of the run panicked; please report this".to_owned();
            Err(ClientError::InvalidReply { message })
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
    mut on_event: impl FnMut(RunUpdate<'_>),
) -> (MeasuredPositions, Torques) {
    let mut streamed = MeasuredPositions::default();
    let mut torques = Torques::default();
    let mut runs = false;
    while !has_ended() {
        if to_stop() {
            // Repeated until the end: the run may not have started at the first stop.
            on_event(RunUpdate::Stopped(&stopper.stop()));
        }
        match stream.next(POLL) {
            Ok(Some(Published::Joints { t_s, joints_rad })) if runs => {
                streamed.t_s.push(t_s);
                streamed.joints_rad.push(joints_rad);
                on_event(RunUpdate::Progress(t_s - streamed.t_s[0]));
            }
            // The first samples of a run precede the publication of its state.
            Ok(Some(Published::Torques { t_s, measured_nm, .. })) => torques.keep(t_s, measured_nm),
            Ok(Some(Published::State { state, .. })) => runs = state != DriveState::Idle,
            Ok(_) => {}
            Err(error) => {
                on_event(RunUpdate::StreamError(&error));
                thread::sleep(POLL);
            }
        }
    }
    (streamed, torques)
}

/// Returns the stamp of the last sample of a run.
fn last_stamp(result: &Result<Measured, ClientError>) -> Option<f64> {
    let run = match result {
        Ok(run) => run,
        Err(ClientError::Refused { run, .. }) => run.as_deref()?,
        Err(_) => return None,
    };
    run.samples.t_s.last().copied()
}

/// Reads the stream until the positions of `last_s` arrive, which come after the torques of that
/// time.
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

/// Returns the joint positions in rad, unless they are outdated.
#[must_use]
pub fn position(status: &DriveStatus) -> Option<Joints> {
    status.joints_rad.filter(|_| status.fri.session != FriStatus::SILENT)
}

/// Returns the samples since the start of a run, with times relative to the start, torques where
/// known, and the cycle time that the robot program reports.
#[must_use]
pub fn since_start(measured: &Measured, torques: &Torques) -> JointLog {
    let MeasuredPositions { t_s, joints_rad, .. } = &measured.samples;
    let from_s = measured.start_s.or(t_s.first().copied()).unwrap_or_default();
    // Stamps are rounded sums: the first sample may be slightly before the start.
    let first = t_s.partition_point(|t_s| t_s - from_s <= -1e-6);
    let times = t_s[first..].iter().map(|t_s| (t_s - from_s).max(0.0)).collect();
    let positions = joints_rad.get(first..).unwrap_or_default().to_vec();
    let mut log = JointLog::new(times, positions);
    log.cycle_time_s = measured.cycle_time_s;
    if measured.timed_by == Some(TimedBy::CommandedPosition) {
        log.timed_by = CycleClock::CommandedPosition;
    }
    log.torques_nm = torques.at(&t_s[first..]);
    log
}

/// Allowance for runs that take longer than planned, because of overrides, waits and pauses.
const RESERVE_S: f64 = 24.0 * 3600.0;

/// Returns a log with the first and the last possible stamp of the recording of a run. If this log
/// can be written before the robot moves, the recording can be written afterwards.
#[must_use]
pub fn longest_log(planned_s: f64) -> JointLog {
    JointLog::new(vec![0.0, planned_s + RESERVE_S], vec![Joints::default(); 2])
}

/// Returns the current time since 1970.
#[must_use]
pub fn now() -> Duration {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or(DEFAULT_EPOCH)
}

/// Returns the time of the first sample of a log whose last sample has just arrived, since 1970.
#[must_use]
pub fn began(log: &JointLog) -> Duration {
    let last_s = log.t_s.last().copied().unwrap_or_default();
    now().saturating_sub(Duration::try_from_secs_f64(last_s).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use iiwa_kin::Robot;
    use iiwa_log::{Config, WriteError};

    use super::*;

    #[test]
    fn recordings_that_could_pass_2038_are_found_before_the_run() {
        let write = |epoch, planned_s: f64| {
            let file = Config { epoch, ..Config::default() };
            longest_log(planned_s).to_mcap(file, &Robot::default(), "").map(drop)
        };
        let last = Duration::from_secs(i32::MAX as u64);
        let before = |days: u64| last.saturating_sub(Duration::from_hours(24 * days));
        write(before(2), 60.0).unwrap();
        for (epoch, planned_s) in [(before(1), 60.0), (before(20), 20.0 * 86_400.0)] {
            let error = write(epoch, planned_s).unwrap_err();
            assert!(matches!(error, WriteError::StampOutOfRange { .. }), "{error}");
        }
        for epoch in [last + Duration::from_secs(1), 2 * last] {
            let error = write(epoch, 60.0).unwrap_err();
            assert!(matches!(error, WriteError::EpochOutOfRange { .. }), "{error}");
        }
    }
}
