//! The progress of a run: messages of the robot program, events of FRI, and time.

use std::{sync::Arc, time::Instant};

use iiwa_link::{
    message::{Body, Code, DriveState, Refusal, RunEnd},
    robot_program::{Acknowledgement, Instruction, RunId, StateChange},
};

use super::state::{Dispatcher, Output, Purpose, QueryKind, RunStage};
use crate::drive::{
    events::{FriCommand, FriEvent},
    instruction_queue::ACKNOWLEDGE_TIMEOUT,
    run::{FinishedRun, Phase},
    run_replies::RunRecord,
    setpoints::TrajectoryEnd,
};

impl<C> Dispatcher<C> {
    /// The robot program has acknowledged an instruction.
    pub(in crate::drive) fn acknowledged(
        &mut self,
        acknowledgement: Acknowledgement,
        now: Instant,
    ) {
        let Some(purpose) = self.instructions.acknowledged(acknowledgement.seq) else { return };
        match (purpose, acknowledgement.error) {
            (Purpose::Query(requester, _), Some(error)) => self.reply(requester, Err(error)),
            (Purpose::Query(requester, kind), None) => {
                let Acknowledgement { sensors, io, value, .. } = acknowledgement;
                let content = match kind {
                    QueryKind::Sensors => sensors.map(|sensors| Body::Sensors { sensors }),
                    QueryKind::Signals => io.map(|io| Body::Signals { io }),
                    QueryKind::Value => value.map(|value| Body::Value { value }),
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
            (Purpose::End, _) => {}
        }
        self.send_next(now);
    }

    /// The robot program has planned motions. They begin unless they were withdrawn meanwhile.
    fn begin_planned(&mut self, run: RunId, now: Instant) {
        if let RunStage::Running(running) = &mut self.stage
            && running.run == run
            && running.phase == Phase::Planning
        {
            running.phase = Phase::Beginning;
            self.instruct(Instruction::Begin { run }, Purpose::Begin(run), now);
        }
    }

    /// The robot program has sent its state.
    pub(in crate::drive) fn state_changed(&mut self, change: StateChange, now: Instant) {
        let restarted = self.program.as_ref().is_some_and(|(before, _)| before.boot != change.boot);
        let is_back = self.program_lost && self.instructions.purposes().next().is_none();
        if restarted || is_back {
            // A cabinet that was switched off leaves a connection that only looks open.
            self.outputs.push(Output::Reconnect);
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
                _ if change.run != Some(run) && running.is_overdue(now) => {
                    let error = "the robot program no longer knows the run";
                    self.fail(run, Refusal::robot(error), now);
                }
                _ => {}
            }
        }
        if restarted {
            // The program before it has received it, if any.
            self.fail_pending_instruction(now);
        }
        // With each state: a lost instruction must not let the motion continue.
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

    /// A robot program that reports a run has received the instruction that begins it, even if the
    /// acknowledgement was lost. Instructions behind it, such as a stop, must not wait any longer.
    fn infer_acknowledgement(&mut self, change: &StateChange, now: Instant) {
        let ended = change.outcome.as_ref().map(|outcome| outcome.run);
        let is_known = |run: &RunId| change.run == Some(*run) || ended == Some(*run);
        let begins = |purpose: &Purpose<C>| matches!(purpose, Purpose::Plan(run) | Purpose::Begin(run) if is_known(run));
        if let Some(Purpose::Plan(run) | Purpose::Begin(run)) = self.instructions.resolve(begins)
            && let RunStage::Running(running) = &mut self.stage
            && running.run == run
        {
            running.begun(now);
        }
    }

    /// An event of the FRI thread.
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
                    tracing::warn!("FRI comes {source}");
                }
            }
            FriEvent::Ended(end) => self.trajectory_ended(end, now),
            // The trajectory was stopped before it began.
            FriEvent::Discarded => self.end_by(Instruction::Stop, now),
            FriEvent::Freed(_) => {}
        }
    }

    /// A trajectory has ended on this side: the robot program ends commanding, and then reports idle.
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
        self.reply_to_stoppers(now);
        self.send_next(now);
        self.refuse_overdue(now);
    }

    /// The pending instruction will not be acknowledged: the robot program is disconnected or has restarted.
    fn fail_pending_instruction(&mut self, now: Instant) {
        if let Some(purpose) = self.instructions.resolve(|_| true) {
            self.instruction_failed(purpose, now);
        }
    }

    /// An instruction was not acknowledged in time.
    fn instruction_failed(&mut self, purpose: Purpose<C>, now: Instant) {
        self.outputs.push(Output::Reconnect);
        match purpose {
            Purpose::Query(requester, _) => self.reply(requester, Err(timed_out())),
            Purpose::Plan(run) | Purpose::Begin(run) => self.fail(run, timed_out(), now),
            Purpose::End => {}
        }
    }

    /// Refuses queries that have waited for too long: their clients have given them up, so they must not
    /// be carried out any more.
    fn refuse_overdue(&mut self, now: Instant) {
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

    /// A run has failed, or did not begin.
    pub(super) fn fail(&mut self, run: RunId, error: Refusal, now: Instant) {
        if let RunStage::Running(running) = &mut self.stage
            && running.run == run
        {
            if running.phase != Phase::Planning {
                self.abandoned = Some(now);
            }
            running.fail(error, now);
            self.finish();
            // It must not begin any more; if it does, or has begun, it is stopped by its number.
            self.instructions.withdraw(|purpose, _| {
                matches!(purpose, Purpose::Plan(other) | Purpose::Begin(other) if *other == run)
            });
        }
    }

    /// Replies with the measurements; the state is idle again.
    fn finish(&mut self) {
        let running = match std::mem::replace(&mut self.stage, RunStage::Idle) {
            RunStage::Running(running) => running,
            stage => {
                self.stage = stage;
                return;
            }
        };
        if running.kind == DriveState::RunningTrajectory {
            self.outputs.push(Output::Fri(FriCommand::Release));
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
        self.outputs.push(Output::Fri(FriCommand::Publish(DriveState::Idle)));
    }
}

fn timed_out() -> Refusal {
    Refusal::new(Code::Timeout, "the robot program did not answer in time")
}
