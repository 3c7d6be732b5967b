//! Execution of goals on the drive: one at a time in a thread, stops in another thread.

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

/// Time-out of waiting for a job, after which the shutdown flag is checked.
const POLL: Duration = Duration::from_millis(50);

/// Poll interval for stops.
const LOOK: Duration = Duration::from_millis(5);

/// Interval between stops of the same run: the first stop may have preceded the run.
const STOP_AGAIN: Duration = Duration::from_millis(200);

/// Maximum number of stops sent at the end of the bridge: by then, the robot is at rest or the
/// drive is unreachable.
const LAST_STOPS: usize = 25;

/// Margin of the run time-out over the duration: starts and ends have separate time-outs in the
/// drive.
const LONGER: Duration = Duration::from_mins(1);

/// Stage of the current job. Only [`Runner`] resets the stage to idle, so that a stop never applies
/// to a later job.
#[derive(Debug, Default)]
struct JobStage(AtomicU8);

impl JobStage {
    const IDLE: u8 = 0;
    const RUNNING: u8 = 1;
    const STOPPING: u8 = 2;

    fn is_at(&self, stage: u8) -> bool {
        self.0.load(Ordering::Acquire) == stage
    }

    /// Advances to stage `to`, if the current stage is `from`.
    fn advance(&self, from: u8, to: u8) -> bool {
        self.0.compare_exchange(from, to, Ordering::AcqRel, Ordering::Acquire).is_ok()
    }

    fn end(&self) {
        self.0.store(Self::IDLE, Ordering::Release);
    }
}

/// A goal to be executed.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) goal: Goal,
    pub(super) retiming: Retiming,
    /// Current joint positions, if known.
    pub(super) from: Option<Joints>,
}

/// Progress of a job.
#[derive(Debug)]
pub(super) enum JobProgress {
    /// The motion that is about to run.
    Begun(Arc<TimedJoints>),
    /// The job has ended.
    Ended {
        /// Outcome of the goal.
        end: End,
        /// Result for the client.
        result: FollowResult,
    },
}

/// Threads that execute goals on a robot's drive. Dropping this value stops the robot on its path,
/// because the goal could not be cancelled any more.
#[derive(Debug)]
pub(super) struct Execution {
    jobs: SyncSender<Job>,
    stage: Arc<JobStage>,
    _threads: ThreadGroup,
}

impl Execution {
    /// Starts the threads; `run` and `stop` are clients of the same drive.
    pub(super) fn start(
        robot: Robot,
        joints: [String; 7],
        run: Client,
        stop: Client,
        progress: UnboundedSender<JobProgress>,
    ) -> Result<Self, Ros2Error> {
        let mut threads = ThreadGroup::default();
        let (jobs, jobs_in) = sync_channel(1);
        let stage = Arc::new(JobStage::default());
        let (client, shared_stage) = (Mutex::new(run), Arc::clone(&stage));
        let runner = Runner { robot, joints, client, stage: shared_stage, progress };
        threads.spawn("ros2 runs", move |shutdown| runner.run(&jobs_in, shutdown))?;
        let shared_stage = Arc::clone(&stage);
        threads.spawn("ros2 stops", move |shutdown| stop_runs(stop, &shared_stage, shutdown))?;
        Ok(Self { jobs, stage, _threads: threads })
    }

    /// Starts a job; returns `false` if another one has not ended.
    pub(super) fn start_job(&self, job: Job) -> bool {
        if !self.stage.advance(JobStage::IDLE, JobStage::RUNNING) {
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

    /// Stops the current job on its path, if any.
    pub(super) fn stop(&self) {
        self.stage.advance(JobStage::RUNNING, JobStage::STOPPING);
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
    stage: Arc<JobStage>,
    progress: UnboundedSender<JobProgress>,
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
            // The receiver is dropped only at the end.
            drop(self.progress.send(JobProgress::Ended { end, result }));
        }
    }

    /// Runs a job to its end. Returns a remark for the client.
    fn carry_out(&self, job: Job) -> Result<String, FollowResult> {
        let Job { goal, retiming, from } = job;
        let prepared = prepare(&self.robot, &goal, &retiming, from.as_ref())
            .map_err(|fault| FollowResult::new(FollowResult::INVALID_GOAL, fault))?;
        if self.stage.is_at(JobStage::STOPPING) {
            let reason = "stopped before it began";
            return Err(FollowResult::new(FollowResult::PATH_TOLERANCE_VIOLATED, reason));
        }
        let motion = Arc::new(prepared.motion);
        drop(self.progress.send(JobProgress::Begun(Arc::clone(&motion))));
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

/// Converts a drive error to a result of the action.
fn failed(error: &ClientError) -> FollowResult {
    let (code, text) = match error {
        ClientError::Refused { refusal: Refusal { code, message }, run } => {
            // The run had begun if there are measurements.
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

/// Sends stops while a job is to stop.
fn stop_runs(mut client: Client, stage: &JobStage, shutdown: &AtomicBool) {
    let mut remaining = LAST_STOPS;
    loop {
        let is_over = shutdown.load(Ordering::Relaxed);
        if is_over && (remaining == 0 || stage.is_at(JobStage::IDLE)) {
            return;
        }
        if !stage.is_at(JobStage::STOPPING) {
            thread::sleep(LOOK);
            continue;
        }
        if let Err(error) = client.stop() {
            tracing::warn!("the drive was not stopped: {error}");
        }
        remaining -= usize::from(is_over);
        thread::sleep(STOP_AGAIN);
    }
}

#[cfg(test)]
mod tests {
    use iiwa_link::message::{MeasuredPositions, Run};

    use super::*;

    #[test]
    fn a_stop_is_for_the_present_job_only() {
        let stage = JobStage::default();
        assert!(!stage.advance(JobStage::RUNNING, JobStage::STOPPING));
        assert!(stage.advance(JobStage::IDLE, JobStage::RUNNING));
        assert!(!stage.advance(JobStage::IDLE, JobStage::RUNNING));
        assert!(stage.advance(JobStage::RUNNING, JobStage::STOPPING));
        stage.end();
        assert!(stage.is_at(JobStage::IDLE));
        assert!(!stage.advance(JobStage::RUNNING, JobStage::STOPPING));
    }

    #[test]
    fn refusals_differ_from_aborted_runs() {
        let refused = |code, samples: &[f64]| {
            let joints = vec![[0.0; 7]; samples.len()];
            let run = Run::new(MeasuredPositions::new(samples.to_vec(), joints));
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
