//! Progress of a run: messages of the robot program, FRI events, and deadlines.

use std::{sync::Arc, time::Instant};

use iiwa_link::{
    message::{Code, DriveState, Refusal, ReplyBody, RunEnd},
    robot_program::{Acknowledgement, Instruction, RunId, StateChange},
};

use super::state::{Dispatcher, DispatcherOutput, Purpose, QueryKind, RunStage};
use crate::drive::{
    events::{FriCommand, FriEvent},
    instruction_queue::ACKNOWLEDGE_TIMEOUT,
    run::{FinishedRun, RunProgress},
    run_replies::RunRecord,
    setpoints::TrajectoryEnd,
};

impl<C> Dispatcher<C> {
    /// Handles an acknowledgement of the robot program.
    pub(in crate::drive) fn acknowledged(
        &mut self,
        acknowledgement: Acknowledgement,
        now: Instant,
    ) {
        // Acknowledgements of instructions that have timed out are ignored.
        let Some(purpose) = self.instructions.acknowledged(acknowledgement.seq) else { return };
        match (purpose, acknowledgement.error) {
            (Purpose::Query(requester, _), Some(error)) => self.reply(requester, Err(error)),
            (Purpose::Query(requester, kind), None) => {
                let Acknowledgement { sensors, io, value, .. } = acknowledgement;
                let content = match kind {
                    QueryKind::Sensors => sensors.map(|sensors| ReplyBody::Sensors { sensors }),
                    QueryKind::Signals => io.map(|io| ReplyBody::Signals { io }),
                    QueryKind::Value => value.map(|value| ReplyBody::Value { value }),
                };
                let lacks =
                    || Refusal::robot("the robot program's acknowledgement lacks the value");
                self.reply(requester, content.map(Some).ok_or_else(lacks));
            }
            (Purpose::Plan(run) | Purpose::Begin(run), Some(error)) => self.fail(run, error, now),
            (Purpose::Plan(run), None) => self.begin_planned(run, now),
            (Purpose::Begin(run), None) => {
                if let RunStage::Running(running) = &mut self.stage
                    && running.run == run
                {
                    running.begun(now);
                }
            }
            // An end that fails is repeated with the next state of the run.
            (Purpose::End, _) => {}
        }
        self.send_next(now);
    }

    /// Begins motions that the robot program has planned, unless they were withdrawn meanwhile.
    fn begin_planned(&mut self, run: RunId, now: Instant) {
        if let RunStage::Running(running) = &mut self.stage
            && running.run == run
            && running.phase == RunProgress::Planning
        {
            running.phase = RunProgress::Beginning;
            self.instruct(Instruction::Begin { run }, Purpose::Begin(run), now);
        }
    }

    /// Handles a state change of the robot program.
    pub(in crate::drive) fn state_changed(&mut self, change: StateChange, now: Instant) {
        let restarted = self.program.as_ref().is_some_and(|(before, _)| before.boot != change.boot);
        let is_back = self.program_lost && self.instructions.purposes().next().is_none();
        if restarted || is_back {
            // A cabinet that was switched off leaves a half-open connection.
            self.outputs.push(DispatcherOutput::Reconnect);
        }
        self.infer_acknowledgement(&change, now);
        if let RunStage::Running(running) = &mut self.stage {
            let run = running.run;
            match &change.outcome {
                Some(outcome) if outcome.run == run => {
                    let ahead_s = self.observation.map_or(0.0, |it| it.clock_ahead_s);
                    running.end(outcome, ahead_s, now);
                }
                _ if restarted => {
                    let error = "the robot program restarted during the run";
                    self.fail(run, Refusal::robot(error), now);
                }
                // Not at once: this state may have been sent before the run began.
                _ if change.run != Some(run) && running.is_overdue(now) => {
                    let error = "the robot program no longer knows the run";
                    self.fail(run, Refusal::robot(error), now);
                }
                _ => {}
            }
        }
        if restarted {
            // If the instruction was received, then by the program before the restart: it is not
            // acknowledged any more.
            self.fail_pending_instruction(now);
        }
        // Repeated with each state: a lost instruction must not let the motion continue.
        if let Some(end) = change.run.and_then(|run| self.end_of(run, change.state)) {
            self.instruct_end(end, now);
        }
        if restarted || self.program_at(now).is_none() {
            tracing::info!("the robot program is connected");
            self.program_lost = false;
        }
        self.program = Some((change, now));
        self.tick(now);
    }

    /// Infers a lost acknowledgement: a robot program that reports a run has received the
    /// instruction that begins this run. Later instructions, such as a stop, must not wait any
    /// longer.
    fn infer_acknowledgement(&mut self, change: &StateChange, now: Instant) {
        let ended = change.outcome.as_ref().map(|outcome| outcome.run);
        let is_known = |run: &RunId| change.run == Some(*run) || ended == Some(*run);
        let begins = |purpose: &Purpose<C>| match purpose {
            Purpose::Plan(run) | Purpose::Begin(run) => is_known(run),
            _ => false,
        };
        if let Some(Purpose::Plan(run) | Purpose::Begin(run)) = self.instructions.resolve(begins)
            && let RunStage::Running(running) = &mut self.stage
            && running.run == run
        {
            running.begun(now);
        }
    }

    /// Handles an event of the FRI thread.
    pub(in crate::drive) fn fri_event(&mut self, event: FriEvent, now: Instant) {
        match event {
            FriEvent::Observed(observation) => {
                let session = (observation.session, observation.quality);
                if self.observation.is_none_or(|it| (it.session, it.quality) != session) {
                    tracing::info!("FRI: {}, quality {}", session.0.name(), session.1.name());
                }
                self.observation = Some(observation);
                self.unexpected = None;
                if let RunStage::Running(running) = &mut self.stage {
                    running.record(&observation);
                }
            }
            FriEvent::Unexpected(source) => {
                if self.unexpected.replace(source).is_none_or(|it| it.from != source.from) {
                    tracing::warn!("FRI messages arrive {source}");
                }
            }
            FriEvent::Ended(end) => self.trajectory_ended(end, now),
            // The trajectory was stopped before it began.
            FriEvent::Discarded => self.end_by(Instruction::Stop, now),
            // The task is freed with this event.
            FriEvent::Freed(_) => {}
        }
    }

    /// Handles the end of a trajectory on the drive side: the robot program is instructed to end
    /// commanding, and then reports idle.
    fn trajectory_ended(&mut self, end: TrajectoryEnd, now: Instant) {
        if let RunStage::Running(running) = &mut self.stage
            && running.run == end.run
        {
            let run = end.run;
            running.trajectory_end = Some(end);
            self.end_by(Instruction::EndTrajectory { run }, now);
        }
    }

    /// Checks deadlines.
    pub(in crate::drive) fn tick(&mut self, now: Instant) {
        if let Some(purpose) = self.instructions.expired(now) {
            self.instruction_failed(purpose, now);
        }
        let lost = self.program_at(now).is_none();
        if lost && self.program.is_some() && !self.program_lost {
            self.program_lost = true;
            tracing::warn!("no messages arrive from the robot program");
            self.fail_pending_instruction(now);
        }
        if let RunStage::Running(running) = &self.stage {
            if running.is_complete(self.observation.as_ref(), now) {
                self.finish();
            } else if lost && !running.has_ended() {
                let run = running.run;
                let error = Refusal::robot("the robot program no longer answers");
                self.fail(run, error, now);
            }
        }
        // Called after `finish`: a completed run must not delay replies to stop requests.
        self.reply_to_stoppers(now);
        self.send_next(now);
        self.reject_overdue(now);
    }

    /// Fails the pending instruction, because it will not be acknowledged: the robot program is
    /// disconnected or has restarted.
    fn fail_pending_instruction(&mut self, now: Instant) {
        if let Some(purpose) = self.instructions.resolve(|_| true) {
            self.instruction_failed(purpose, now);
        }
    }

    /// Handles an instruction that was not acknowledged in time.
    fn instruction_failed(&mut self, purpose: Purpose<C>, now: Instant) {
        // The instruction must not arrive later over the old connection.
        self.outputs.push(DispatcherOutput::Reconnect);
        match purpose {
            Purpose::Query(requester, _) => self.reply(requester, Err(timed_out())),
            Purpose::Plan(run) | Purpose::Begin(run) => self.fail(run, timed_out(), now),
            Purpose::End => {}
        }
    }

    /// Refuses overdue queries: their clients no longer wait for a reply, so these queries must not
    /// be carried out any more.
    fn reject_overdue(&mut self, now: Instant) {
        let is_overdue = |purpose: &Purpose<C>, since| {
            matches!(purpose, Purpose::Query(..))
                && now.saturating_duration_since(since) >= ACKNOWLEDGE_TIMEOUT
        };
        for purpose in self.instructions.withdraw(is_overdue) {
            if let Purpose::Query(requester, _) = purpose {
                self.reply(requester, Err(timed_out()));
            }
        }
    }

    /// Fails a run that was aborted or did not begin.
    pub(super) fn fail(&mut self, run: RunId, error: Refusal, now: Instant) {
        if let RunStage::Running(running) = &mut self.stage
            && running.run == run
        {
            // Without `begin`, planned motions never start; later, the run may have begun.
            if running.phase != RunProgress::Planning {
                self.abandoned = Some(now);
            }
            running.fail(error, now);
            self.finish();
            // The run must not begin any more; if it begins or has begun, it is stopped by its
            // number.
            self.instructions.withdraw(|purpose, _| {
                matches!(purpose, Purpose::Plan(other) | Purpose::Begin(other) if *other == run)
            });
        }
    }

    /// Replies with the measurements and returns to the idle state.
    fn finish(&mut self) {
        let running = match std::mem::replace(&mut self.stage, RunStage::Idle) {
            RunStage::Running(running) => running,
            stage => {
                self.stage = stage;
                return;
            }
        };
        // Also after a failure, when set-points may still be sent.
        if running.kind == DriveState::RunningTrajectory {
            self.outputs.push(DispatcherOutput::Fri(FriCommand::Release));
        }
        let (number, kind) = (running.run, running.kind);
        let label = running.label.clone();
        let FinishedRun { run, error, has_begun, requester } = running.finish();
        match &error {
            None => tracing::info!("run {number}: done"),
            Some(error) => tracing::warn!("run {number}: {error}"),
        }
        self.publish_run(number, kind, &label, Some(RunEnd::new(&run, error.clone())));
        let record = Arc::new(RunRecord::new(run, error));
        if has_begun {
            self.last_run = Some(record.clone());
        }
        self.reply_run(requester, record);
        self.outputs.push(DispatcherOutput::Fri(FriCommand::Publish(DriveState::Idle)));
    }
}

fn timed_out() -> Refusal {
    Refusal::new(Code::Timeout, "the robot program did not answer in time")
}
