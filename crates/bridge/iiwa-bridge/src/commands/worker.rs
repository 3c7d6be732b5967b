//! Forwards the commands for a robot to its drive. Runs, stops and other requests have separate
//! threads, so that a stop overtakes them all.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
    mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
};
use std::{thread, time::Duration};

use iiwa_link::{
    Client, LinkError,
    message::{Code, Refusal, Request},
    threads::ThreadGroup,
};

use super::replies::{Answer, CommandReply};
use crate::{BridgeError, robot::BridgedRobot};

/// Maximum number of commands other than runs that wait for the drive.
const BACKLOG: usize = 16;

/// Time-out of replies to commands other than runs.
const REPLY_TIMEOUT: Duration = Duration::from_secs(5);

/// Threads that forward the commands for a robot.
#[derive(Debug)]
pub(super) struct Worker {
    runs: SyncSender<CommandJob>,
    /// `true` during a run: a second run would wait for the end of the first, and then begin
    /// unexpectedly.
    is_running: Arc<AtomicBool>,
    others: SyncSender<CommandJob>,
    /// Separate queue, so that stops overtake all other commands.
    stops: SyncSender<CommandJob>,
    /// Threads except the run thread, which may wait for the end of a run that continues without
    /// its client.
    _threads: ThreadGroup,
}

struct CommandJob {
    id: String,
    request: Request,
    answer: Answer,
}

impl Worker {
    pub(super) fn start(robot: &BridgedRobot) -> Result<Self, BridgeError> {
        let mut threads = ThreadGroup::default();
        let (runs, runs_in) = sync_channel(1);
        let (others, others_in) = sync_channel(BACKLOG);
        let is_running = Arc::new(AtomicBool::new(false));
        let (name, client) = (robot.name().to_owned(), robot.client()?);
        let running = Arc::clone(&is_running);
        let finish = move || running.store(false, Ordering::Release);
        thread::Builder::new()
            .name("bridge runs".to_owned())
            .spawn(move || carry_out(&name, client, None, &runs_in, &finish))
            .map_err(|source| LinkError::Thread { source })?;
        let (name, client) = (robot.name().to_owned(), robot.client()?);
        threads.spawn("bridge commands", move |_| {
            carry_out(&name, client, Some(REPLY_TIMEOUT), &others_in, &|| ());
        })?;
        let (stops, stops_in) = sync_channel(BACKLOG);
        let (name, client) = (robot.name().to_owned(), robot.client()?);
        threads.spawn("bridge stops", move |_| {
            carry_out(&name, client, Some(REPLY_TIMEOUT), &stops_in, &|| ());
        })?;
        Ok(Self { runs, is_running, others, stops, _threads: threads })
    }

    /// Queues a request; if the queue is full, returns the reason and the reply callback.
    pub(super) fn send(
        &self,
        id: String,
        request: Request,
        answer: Answer,
    ) -> Result<(), (Refusal, Answer)> {
        let is_run = matches!(request, Request::RunMotions { .. } | Request::RunTrajectory { .. });
        let job = CommandJob { id, request, answer };
        if is_run && self.is_running.swap(true, Ordering::AcqRel) {
            let reason = "another run that was requested through the bridge is not over yet";
            return Err((Refusal::new(Code::NotIdle, reason), job.answer));
        }
        let to = match job.request {
            Request::RunMotions { .. } | Request::RunTrajectory { .. } => &self.runs,
            Request::Stop => &self.stops,
            _ => &self.others,
        };
        to.try_send(job).map_err(|error| {
            let (TrySendError::Full(job) | TrySendError::Disconnected(job)) = error;
            (Refusal::robot("too many commands wait for the drive"), job.answer)
        })
    }
}

/// Forwards requests until the queue is closed.
fn carry_out(
    robot: &str,
    mut client: Client,
    limit: Option<Duration>,
    jobs: &Receiver<CommandJob>,
    finish: &dyn Fn(),
) {
    for CommandJob { id, request, answer } in jobs {
        let reply = match client.reply(&request, limit) {
            Ok(reply) => CommandReply::new(Some(robot.to_owned()), Some(id), &reply),
            Err(error) => {
                let refusal = Refusal::new(error.code(), error.to_string());
                CommandReply::refused(Some(robot.to_owned()), Some(id), &refusal)
            }
        };
        finish();
        answer(reply);
    }
}
