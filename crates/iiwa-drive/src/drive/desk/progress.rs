//! How a run goes on: what the robot program and FRI say, and what time does.

use std::{sync::Arc, time::Instant};

use iiwa_link::message::Refusal;

use super::{
    Asked, Body, Desk, DriveState, Event, Left, Measured, Order, Output, Over, Phase, Purpose,
    State, Wanted, unanswered,
};
use crate::{
    drive::instructions::ACKNOWLEDGED_WITHIN,
    robot_program::{Acknowledgement, Instruction, RunId, StateChange},
};

impl<C> Desk<C> {
    /// The robot program has acknowledged an instruction.
    pub(in crate::drive) fn acknowledged(&mut self, answer: Acknowledgement, now: Instant) {
        let Some(purpose) = self.instructions.acknowledged(answer.seq) else { return };
        match (purpose, answer.error) {
            (Purpose::Ask(asked, _), Some(error)) => self.reply(asked, Err(error)),
            (Purpose::Ask(asked, wanted), None) => {
                let brought = match (wanted, answer.sensors, answer.value) {
                    (Wanted::Sensors, Some(sensors), _) => Ok(Some(Body::Sensors { sensors })),
                    (Wanted::Value, _, Some(value)) => Ok(Some(Body::Value { value })),
                    _ => Err(Refusal::robot("the robot program's answer lacks what was asked for")),
                };
                self.reply(asked, brought);
            }
            (Purpose::Plan(run) | Purpose::Begin(run), Some(error)) => self.fail(run, error, now),
            (Purpose::Plan(run), None) => self.begin_planned(run, now),
            (Purpose::Begin(run), None) => {
                if let State::Running(running) = &mut self.state
                    && running.run == run
                {
                    running.take(now);
                }
            }
            (Purpose::End, _) => {}
        }
        self.send_next(now);
    }

    /// The robot program has planned motions. If they were withdrawn meanwhile, they never begin.
    fn begin_planned(&mut self, run: RunId, now: Instant) {
        if let State::Running(running) = &mut self.state
            && running.run == run
            && running.phase == Phase::Planning
        {
            running.phase = Phase::Beginning;
            self.instruct(Instruction::Begin { run }, Purpose::Begin(run), now);
        }
    }

    /// The robot program has said its state.
    pub(in crate::drive) fn changed(&mut self, change: StateChange, now: Instant) {
        let restarted = self.program.as_ref().is_some_and(|(before, _)| before.boot != change.boot);
        self.take_for_acknowledged(&change, now);
        if restarted && !matches!(self.state, State::Running(_)) {
            // A run says so by itself.
            self.settle_all(now);
        }
        if let State::Running(running) = &mut self.state {
            let run = running.run;
            match &change.outcome {
                Some(outcome) if outcome.run == run => {
                    let ahead_s = self.heard.map_or(0.0, |heard| heard.clock_ahead_s);
                    running.end(outcome, ahead_s, now);
                }
                _ if restarted => {
                    let error = "the robot program was started again in the middle of the run";
                    self.fail(run, Refusal::robot(error), now);
                }
                _ if change.run != Some(run) && running.is_forgotten(now) => {
                    let error = "the robot program does not know of the run any more";
                    self.fail(run, Refusal::robot(error), now);
                }
                _ => {}
            }
        }
        // At each word, so that nothing moves on because an instruction got lost.
        if let Some(end) = change.run.and_then(|run| self.end_of(run, change.state)) {
            self.tell_end(end, now);
        }
        if restarted || self.program_at(now).is_none() {
            tracing::info!("the robot program is there");
            self.program_lost = false;
        }
        self.program = Some((change, now));
        self.tick(now);
    }

    /// The robot program speaks of the run: it has the instruction that begins it, even if its
    /// acknowledgement got lost. What waits behind that, as a stop, must not wait any longer.
    fn take_for_acknowledged(&mut self, change: &StateChange, now: Instant) {
        let ended = change.outcome.as_ref().map(|outcome| outcome.run);
        let is_known = |run: &RunId| change.run == Some(*run) || ended == Some(*run);
        let begins = |purpose: &Purpose<C>| matches!(purpose, Purpose::Plan(run) | Purpose::Begin(run) if is_known(run));
        if let Some(Purpose::Plan(run) | Purpose::Begin(run)) = self.instructions.settle(begins)
            && let State::Running(running) = &mut self.state
            && running.run == run
        {
            running.take(now);
        }
    }

    /// The FRI thread has told something.
    pub(in crate::drive) fn heard(&mut self, event: Event, now: Instant) {
        match event {
            Event::Heard(heard) => {
                let session = (heard.session, heard.quality);
                if self.heard.is_none_or(|before| (before.session, before.quality) != session) {
                    tracing::info!("FRI: {}, quality {}", session.0.name(), session.1.name());
                }
                self.heard = Some(heard);
                if let State::Running(running) = &mut self.state {
                    running.keep(&heard);
                }
            }
            Event::Over(over) => self.commanded(over, now),
            Event::Discarded => {
                // It was to be stopped before it began.
                self.end_by(Instruction::Stop, now);
            }
            Event::Freed(_) => {}
        }
    }

    /// A trajectory is over on this side: the robot program is told, and says idle then.
    fn commanded(&mut self, over: Over, now: Instant) {
        if let State::Running(running) = &mut self.state
            && running.run == over.run
        {
            let run = over.run;
            running.commanded = Some(over);
            self.end_by(Instruction::EndTrajectory { run }, now);
        }
    }

    /// Time passes.
    pub(in crate::drive) fn tick(&mut self, now: Instant) {
        if let Some(purpose) = self.instructions.expired(now) {
            self.unanswered(purpose, now);
        }
        let lost = self.program_at(now).is_none();
        if lost && self.program.is_some() && !self.program_lost {
            self.program_lost = true;
            tracing::warn!("the robot program is silent");
            self.settle_all(now);
        }
        if let State::Running(running) = &self.state {
            if running.is_complete(self.heard.as_ref(), now) {
                self.finish();
            } else if lost && !running.has_ended() {
                let run = running.run;
                let error = Refusal::robot("the robot program does not answer any more");
                self.fail(run, error, now);
            }
        }
        self.answer_stoppers(now);
        self.send_next(now);
        self.refuse_waiting(now);
    }

    /// What is on its way to the robot program will not be acknowledged: it has gone, or begun anew.
    fn settle_all(&mut self, now: Instant) {
        if let Some(purpose) = self.instructions.settle(|_| true) {
            self.unanswered(purpose, now);
        }
    }

    /// An instruction is not acknowledged.
    fn unanswered(&mut self, purpose: Purpose<C>, now: Instant) {
        self.outputs.push(Output::Reconnect);
        match purpose {
            Purpose::Ask(asked, _) => self.reply(asked, Err(unanswered())),
            Purpose::Plan(run) | Purpose::Begin(run) => self.fail(run, unanswered(), now),
            Purpose::End => {}
        }
    }

    /// Refuses what has waited for too long: clients give it up, and it is not to be done behind their
    /// backs.
    fn refuse_waiting(&mut self, now: Instant) {
        let is_late = |purpose: &Purpose<C>, since| {
            matches!(purpose, Purpose::Ask(..))
                && now.saturating_duration_since(since) >= ACKNOWLEDGED_WITHIN
        };
        for purpose in self.instructions.withdraw(is_late) {
            if let Purpose::Ask(asked, _) = purpose {
                self.reply(asked, Err(unanswered()));
            }
        }
    }

    /// A run has failed, or never begun.
    pub(super) fn fail(&mut self, run: RunId, error: Refusal, now: Instant) {
        if let State::Running(running) = &mut self.state
            && running.run == run
        {
            if running.phase != Phase::Planning {
                self.given_up = Some(now);
            }
            running.fail(error, now);
            self.finish();
            // It is not to begin any more; if it does, or has, it is stopped by its number.
            self.instructions.withdraw(|purpose, _| {
                matches!(purpose, Purpose::Plan(other) | Purpose::Begin(other) if *other == run)
            });
        }
    }

    /// Replies with what was measured; then the state is idle again.
    fn finish(&mut self) {
        let running = match std::mem::replace(&mut self.state, State::Idle) {
            State::Running(running) => running,
            state => {
                self.state = state;
                return;
            }
        };
        if running.kind == DriveState::RunningTrajectory {
            self.outputs.push(Output::Order(Order::Release));
        }
        let number = running.run;
        let Left { run, error, was_taken, asked } = running.leave();
        match &error {
            None => tracing::info!("run {number}: done"),
            Some(error) => tracing::warn!("run {number}: {error}"),
        }
        let measured = Arc::new(Measured::new(run, error));
        if was_taken {
            self.last_run = Some(measured.clone());
        }
        let asked: Asked<C> = asked;
        self.answer(asked, measured);
        self.outputs.push(Output::Order(Order::Publish(DriveState::Idle)));
    }
}
