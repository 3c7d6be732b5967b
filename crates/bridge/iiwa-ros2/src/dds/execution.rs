//! Runs goals on the drive: one at a time in a thread, stops in another.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU8, Ordering},
        mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel},
    },
    thread,
    time::Duration,
};

use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    Client, ClientError, TimedJoints,
    message::{Code, Refusal, Request, RunLabel},
    threads::ThreadGroup,
};
use tokio::sync::mpsc::UnboundedSender;

use super::{
    error::Ros2Error,
    goal::Goal,
    goals::End,
    messages::FollowResult,
    retiming::{Retiming, prepare},
};

/// How long to wait for a job before the end is checked for.
const POLL: Duration = Duration::from_millis(50);

/// How often a stop is looked for.
const LOOK: Duration = Duration::from_millis(5);

/// Time between two stops of the same run: the first may have come before it.
const STOP_AGAIN: Duration = Duration::from_millis(200);

/// Stops that are sent at the end of the bridge, at most: until then the arm is at rest, or the drive is gone.
const LAST_STOPS: usize = 25;

/// How much longer than its duration a run may take: starts and ends have time-outs of their own in the drive.
const LONGER: Duration = Duration::from_mins(1);

/// What becomes of the present job. Only [`Runner`] leaves it idle, so that no stop is meant for what follows.
#[derive(Debug, Default)]
struct Stage(AtomicU8);

impl Stage {
    const IDLE: u8 = 0;
    const RUNNING: u8 = 1;
    const STOPPING: u8 = 2;

    fn is(&self, stage: u8) -> bool {
        self.0.load(Ordering::Acquire) == stage
    }

    /// Goes on to the next stage, if it is in the one before.
    fn advance(&self, from: u8, to: u8) -> bool {
        self.0.compare_exchange(from, to, Ordering::AcqRel, Ordering::Acquire).is_ok()
    }

    fn end(&self) {
        self.0.store(Self::IDLE, Ordering::Release);
    }
}

/// A goal that is to run.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) goal: Goal,
    pub(super) retiming: Retiming,
    /// Where the arm is, if it is known.
    pub(super) from: Option<Joints>,
}

/// What becomes of a job.
#[derive(Debug)]
pub(super) enum Progress {
    /// This is going to run.
    Begun(Arc<TimedJoints>),
    /// It is over.
    Ended {
        /// Whether the arm is at the goal.
        end: End,
        /// What the client hears.
        result: FollowResult,
    },
}

/// The threads that run goals on a robot's drive. When it is dropped, the arm stops on its path: nobody could cancel the goal.
#[derive(Debug)]
pub(super) struct Execution {
    jobs: SyncSender<Job>,
    stage: Arc<Stage>,
    _threads: ThreadGroup,
}

impl Execution {
    /// Starts them; `run` and `stop` are clients of the same drive.
    pub(super) fn start(
        robot: Robot,
        joints: [String; 7],
        run: Client,
        stop: Client,
        progress: UnboundedSender<Progress>,
    ) -> Result<Self, Ros2Error> {
        let mut threads = ThreadGroup::default();
        let (jobs, jobs_in) = sync_channel(1);
        let stage = Arc::new(Stage::default());
        let (client, own) = (Mutex::new(run), Arc::clone(&stage));
        let runner = Runner { robot, joints, client, stage: own, progress };
        threads.spawn("ros2 runs", move |shutdown| runner.run(&jobs_in, shutdown))?;
        let own = Arc::clone(&stage);
        threads.spawn("ros2 stops", move |shutdown| stop_runs(stop, &own, shutdown))?;
        Ok(Self { jobs, stage, _threads: threads })
    }

    /// Hands a job over; false if another one is not over.
    pub(super) fn start_job(&self, job: Job) -> bool {
        if !self.stage.advance(Stage::IDLE, Stage::RUNNING) {
            return false;
        }
        match self.jobs.try_send(job) {
            Ok(()) => true,
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {
                self.stage.end();
                false
            }
        }
    }

    /// Stops the job on its path, if there is one.
    pub(super) fn stop(&self) {
        self.stage.advance(Stage::RUNNING, Stage::STOPPING);
    }
}

impl Drop for Execution {
    fn drop(&mut self) {
        self.stop();
    }
}

struct Runner {
    robot: Robot,
    joints: [String; 7],
    client: Mutex<Client>,
    stage: Arc<Stage>,
    progress: UnboundedSender<Progress>,
}

impl Runner {
    fn run(&self, jobs: &Receiver<Job>, shutdown: &AtomicBool) {
        while !shutdown.load(Ordering::Relaxed) {
            let job = match jobs.recv_timeout(POLL) {
                Ok(job) => job,
                Err(RecvTimeoutError::Timeout) => continue,
                Err(RecvTimeoutError::Disconnected) => return,
            };
            let (end, result) = match self.carry_out(job) {
                Ok(remark) => (End::Reached, FollowResult::new(FollowResult::SUCCESSFUL, remark)),
                Err(result) => (End::Failed, result),
            };
            self.stage.end();
            // The receiver is gone at the end only.
            drop(self.progress.send(Progress::Ended { end, result }));
        }
    }

    /// Runs a job to its end. Returns what there is to say of it.
    fn carry_out(&self, job: Job) -> Result<String, FollowResult> {
        let Job { goal, retiming, from } = job;
        let prepared = prepare(&self.robot, &goal, &retiming, from.as_ref())
            .map_err(|fault| FollowResult::new(FollowResult::INVALID_GOAL, fault))?;
        if self.stage.is(Stage::STOPPING) {
            let why = "stopped before it began";
            return Err(FollowResult::new(FollowResult::PATH_TOLERANCE_VIOLATED, why));
        }
        let motion = Arc::new(prepared.motion);
        drop(self.progress.send(Progress::Begun(Arc::clone(&motion))));
        let mut client = self.client.lock().unwrap_or_else(PoisonError::into_inner);
        let limit = Duration::try_from_secs_f64(motion.duration_s()).unwrap_or_default() + LONGER;
        let request =
            Request::trajectory((*motion).clone()).labelled(RunLabel::of_robot(&self.robot));
        let run = client.run(&request, Some(limit));
        let run = run.map_err(|error| failed(&error))?;
        let end = run.samples.joints_rad.last();
        match end.and_then(|q| goal.missed_by(&self.joints, q)) {
            Some(missed) => Err(FollowResult::new(FollowResult::GOAL_TOLERANCE_VIOLATED, missed)),
            None => Ok(prepared.remark),
        }
    }
}

/// What a drive's error is called in the action.
fn failed(error: &ClientError) -> FollowResult {
    let (code, text) = match error {
        ClientError::Refused { refusal: Refusal { code, message }, run } => {
            // With measurements it had begun.
            let moved = run.as_ref().is_some_and(|run| !run.samples.t_s.is_empty());
            let code = match code {
                Code::Robot | Code::Timeout if moved => FollowResult::PATH_TOLERANCE_VIOLATED,
                _ => FollowResult::INVALID_GOAL,
            };
            (code, message.clone())
        }
        other => (FollowResult::INVALID_GOAL, other.to_string()),
    };
    FollowResult::new(code, text)
}

/// Sends stops as long as a job is to stop.
fn stop_runs(mut client: Client, stage: &Stage, shutdown: &AtomicBool) {
    let mut left = LAST_STOPS;
    loop {
        let is_over = shutdown.load(Ordering::Relaxed);
        if is_over && (left == 0 || stage.is(Stage::IDLE)) {
            return;
        }
        if !stage.is(Stage::STOPPING) {
            thread::sleep(LOOK);
            continue;
        }
        if let Err(error) = client.stop() {
            tracing::warn!("the drive was not stopped: {error}");
        }
        left -= usize::from(is_over);
        thread::sleep(STOP_AGAIN);
    }
}

#[cfg(test)]
mod tests {
    use iiwa_link::message::{Run, Samples};

    use super::*;

    #[test]
    fn a_stop_is_for_the_present_job_only() {
        let stage = Stage::default();
        assert!(!stage.advance(Stage::RUNNING, Stage::STOPPING));
        assert!(stage.advance(Stage::IDLE, Stage::RUNNING));
        assert!(!stage.advance(Stage::IDLE, Stage::RUNNING));
        assert!(stage.advance(Stage::RUNNING, Stage::STOPPING));
        stage.end();
        assert!(stage.is(Stage::IDLE));
        assert!(!stage.advance(Stage::RUNNING, Stage::STOPPING));
    }

    #[test]
    fn refusals_are_told_apart_from_aborted_runs() {
        let refused = |code, samples: &[f64]| {
            let joints = vec![[0.0; 7]; samples.len()];
            let run = Run::new(Samples::new(samples.to_vec(), joints));
            let refusal = Refusal::new(code, "because");
            failed(&ClientError::Refused { refusal, run: Some(Box::new(run)) })
        };
        let limit = refused(Code::Limit, &[]);
        assert_eq!(limit, FollowResult::new(FollowResult::INVALID_GOAL, "because"));
        assert_eq!(refused(Code::Robot, &[]).error_code, FollowResult::INVALID_GOAL);
        let aborted = refused(Code::Robot, &[1.0]);
        assert_eq!(aborted.error_code, FollowResult::PATH_TOLERANCE_VIOLATED);
    }
}
