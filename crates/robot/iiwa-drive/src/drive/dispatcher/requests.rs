//! Client requests, up to the beginning of a run.

use std::time::Instant;

use iiwa_fri::{Quality, SessionState};
use iiwa_link::{
    message::{
        Code, DriveState, MAX_SHORT_REQUEST_BYTES, Refusal, ReplyBody, Request, RequestHead,
        RunLabel,
    },
    robot_program::{Instruction, RunId},
};

use super::state::{
    Dispatcher, DispatcherOutput, IncomingRequest, Purpose, QueryKind, Requester, RunStage,
};
use crate::drive::{
    checks::{CheckJob, CheckedRun, RunTask, UncheckedRun},
    events::{FriCommand, Observation},
    run::{ActiveRun, RunProgress},
};

impl<C> Dispatcher<C> {
    /// Handles a client request.
    pub(in crate::drive) fn request(&mut self, client: C, incoming: IncomingRequest, now: Instant) {
        if incoming.body.len() > MAX_SHORT_REQUEST_BYTES {
            // Only a run request may be that long; parsing its id here would take too long.
            return self.check_run(Requester { client, id: None }, incoming, now);
        }
        let (id, head) = Request::head(&incoming.body);
        let requester = Requester { client, id };
        let is_run =
            |head: &RequestHead<'_>| matches!(head.name(), Some("run_motions" | "run_trajectory"));
        if head.as_ref().is_ok_and(is_run) {
            return self.check_run(requester, incoming, now);
        }
        match head.and_then(RequestHead::parse) {
            Ok(request) => self.serve(requester, request, now),
            Err(refusal) => self.reply(requester, Err(refusal)),
        }
    }

    fn serve(&mut self, requester: Requester<C>, request: Request, now: Instant) {
        let (instruction, kind) = match request {
            Request::State => {
                let status = ReplyBody::Status(Box::new(self.status(now)));
                return self.reply(requester, Ok(Some(status)));
            }
            Request::LastRun => return self.serve_last_run(requester),
            Request::Stop => return self.serve_stop(requester, now),
            Request::ListIo => (Instruction::ListIo, QueryKind::Signals),
            Request::GetIo { name } => (Instruction::GetIo { name }, QueryKind::Value),
            Request::SetIo { name, value } => {
                (Instruction::SetIo { name, value }, QueryKind::Value)
            }
            _ => (Instruction::ReadSensors, QueryKind::Sensors),
        };
        let is_free = self.check_protocol(now).and_then(|()| self.check_idle(now));
        let refusal = match is_free {
            Err(refusal) => refusal,
            // The quota is for queries only: instructions of runs and stops are never refused.
            Ok(()) if self.instructions.is_full() => {
                Refusal::robot("too many requests wait for the robot program")
            }
            Ok(()) => return self.instruct(instruction, Purpose::Query(requester, kind), now),
        };
        self.reply(requester, Err(refusal));
    }

    fn serve_last_run(&mut self, requester: Requester<C>) {
        match self.last_run.clone() {
            None => self.reply(requester, Err(Refusal::bad("there has been no run yet"))),
            Some(record) => self.reply_run(requester, record),
        }
    }

    /// Checks that a run may begin now; returns the latest observation of the robot.
    fn check_free(&self, began: Instant, now: Instant) -> Result<Observation, Refusal> {
        self.check_idle(now)?;
        if matches!(self.stage, RunStage::Checking(..)) {
            let busy = "the robot is busy: another run is about to begin";
            return Err(Refusal::new(Code::NotIdle, busy));
        }
        if !self.stoppers.is_empty() || self.stopped.is_some_and(|stopped| began < stopped) {
            return Err(Refusal::robot("stopped on request, before the run began"));
        }
        self.check_connected(now)
    }

    /// Begins the first stage of a run. The state is checked first: requests that the state forbids
    /// are not parsed.
    fn check_run(&mut self, requester: Requester<C>, incoming: IncomingRequest, now: Instant) {
        let IncomingRequest { body, permit, began } = incoming;
        let is_short = body.len() <= MAX_SHORT_REQUEST_BYTES;
        match self.check_free(began, now) {
            Ok(observation) => {
                let run = self.next_run;
                self.next_run = self.next_run.wrapping_add(1);
                self.stage = RunStage::Checking(run, requester);
                let unchecked = UncheckedRun { run, body, permit, at_rad: observation.joints_rad };
                self.outputs.push(DispatcherOutput::Check(CheckJob::Check(unchecked)));
            }
            Err(refusal) if is_short => self.reply(requester, Err(refusal)),
            // The checking thread parses the id.
            Err(refusal) => {
                let Requester { client, .. } = requester;
                let job = CheckJob::Refuse { client, body, permit, refusal };
                self.outputs.push(DispatcherOutput::Check(job));
            }
        }
    }

    /// Handles the result of a check.
    pub(in crate::drive) fn checked(&mut self, checked: CheckedRun, now: Instant) {
        let CheckedRun { run, id, task } = checked;
        // A check cannot be interrupted: the reply to a withdrawn run waits for its id.
        if let Some(i) = self.withdrawn.iter().position(|(withdrawn, ..)| *withdrawn == run) {
            let (_, requester, refusal) = self.withdrawn.swap_remove(i);
            return self.reply(Requester { id, ..requester }, Err(refusal));
        }
        let requester = match std::mem::replace(&mut self.stage, RunStage::Idle) {
            RunStage::Checking(checking, requester) if checking == run => {
                Requester { id, ..requester }
            }
            stage => {
                self.stage = stage;
                return;
            }
        };
        // The robot may have become busy, or disconnected, meanwhile.
        let ready = task.and_then(|(task, label)| {
            self.check_idle(now)?;
            let observation = self.check_connected(now)?;
            // Motions of the controller do not need commanding over FRI.
            if matches!(task, RunTask::Trajectory(_)) {
                check_session(&observation)?;
            }
            Ok((task, label))
        });
        match ready {
            Ok((task, label)) => self.begin(run, requester, task, label, now),
            Err(refusal) => self.reply(requester, Err(refusal)),
        }
    }

    fn begin(
        &mut self,
        run: RunId,
        requester: Requester<C>,
        task: RunTask,
        label: RunLabel,
        now: Instant,
    ) {
        let (kind, phase) = match task {
            RunTask::Motions(_) => (DriveState::RunningMotion, RunProgress::Planning),
            RunTask::Trajectory(_) => (DriveState::RunningTrajectory, RunProgress::Beginning),
        };
        self.publish_run(run, kind, &label, None);
        let observation = self.observation.as_ref();
        let running = ActiveRun::new(kind, phase, run, label, requester, observation);
        self.stage = RunStage::Running(Box::new(running));
        tracing::info!("run {run}: {kind}");
        self.outputs.push(DispatcherOutput::Fri(FriCommand::Publish(kind)));
        match task {
            RunTask::Motions(motions) => {
                let motions = motions.for_robot_program();
                self.instruct(Instruction::RunMotions { run, motions }, Purpose::Plan(run), now);
            }
            RunTask::Trajectory(trajectory) => {
                // First, so that the trajectory is pending before the session can command.
                self.outputs.push(DispatcherOutput::Fri(FriCommand::Run(run, trajectory)));
                self.instruct(Instruction::RunTrajectory { run }, Purpose::Begin(run), now);
            }
        }
    }
}

/// Checks that the FRI session and quality are sufficient for commanding.
fn check_session(observation: &Observation) -> Result<(), Refusal> {
    if observation.session < SessionState::MonitoringReady || observation.quality < Quality::Good {
        return Err(Refusal::robot(format!(
            "the FRI connection is not good enough for commanding: session {}, quality {}",
            observation.session.name(),
            observation.quality.name()
        )));
    }
    Ok(())
}
