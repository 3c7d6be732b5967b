//! Stops: what has not begun is withdrawn, what has begun is stopped, and who asked is answered once the
//! arm is known to stand.

use std::time::{Duration, Instant};

use iiwa_link::message::{Code, DriveState, Refusal};

use super::{Asked, Desk, Output, Phase, Purpose, State};
use crate::{
    drive::fri::Order,
    robot_program::{Instruction, RunId},
};

/// How long an arm may take to come to rest: an answer within five seconds is what clients wait for.
const STOPPED_WITHIN: Duration = Duration::from_secs(4);

impl<C> Desk<C> {
    pub(super) fn serve_stop(&mut self, asked: Asked<C>, now: Instant) {
        self.stopped = Some(now);
        self.stop("stopped on request", now);
        // What was running before this drive was started, or is not known to stand still.
        if matches!(self.state, State::Idle)
            && self.program_at(now).is_none_or(|said| said.state != DriveState::Idle)
        {
            self.tell_end(Instruction::Stop, now);
        }
        self.stoppers.push((asked, now));
        self.answer_stoppers(now);
    }

    /// A client has gone: what it wanted and has not begun does not begin.
    pub(in crate::drive) fn gone(&mut self, is_gone: impl Fn(&C) -> bool, now: Instant) {
        let of_client = |purpose: &Purpose<C>, _| matches!(purpose, Purpose::Ask(asked, _) if is_gone(&asked.client));
        self.instructions.withdraw(of_client);
        self.stoppers.retain(|(asked, _)| !is_gone(&asked.client));
        let wanted_by = match &self.state {
            State::Checking(_, asked) => Some(&asked.client),
            State::Running(running) if running.phase != Phase::Begun => Some(&running.asked.client),
            _ => None,
        };
        if wanted_by.is_some_and(is_gone) {
            self.stop("its client has gone", now);
        }
    }

    /// Withdraws or stops what there is.
    fn stop(&mut self, why: &str, now: Instant) {
        let before = || Refusal::robot(format!("{why}, before the run was begun"));
        match &self.state {
            State::Idle => {}
            State::Checking(..) => {
                if let State::Checking(run, asked) = std::mem::replace(&mut self.state, State::Idle)
                {
                    self.withdrawn.push((run, asked, before()));
                }
            }
            State::Running(running) if running.phase == Phase::Planning => {
                let run = running.run;
                self.fail(run, before(), now);
            }
            State::Running(running) if running.kind == DriveState::RunningTrajectory => {
                // On its path, by set-points: the cabinet does not know the path.
                self.outputs.push(Output::Order(Order::Stop));
            }
            State::Running(_) => self.end_by(Instruction::Stop, now),
        }
    }

    /// Answers those who wait for the arm to stand, once that is known.
    pub(super) fn answer_stoppers(&mut self, now: Instant) {
        let stands = match (&self.state, self.program_at(now)) {
            (State::Running(_), _) => None,
            (_, None) => Some(Err(Refusal::robot(
                "the robot program does not answer: whether the robot stands is not known",
            ))),
            (_, Some(said)) if said.state != DriveState::Idle => None,
            // It may have begun what was given up.
            _ if self.is_in_doubt() => None,
            _ => Some(Ok(None)),
        };
        let late = || {
            let seconds = STOPPED_WITHIN.as_secs();
            Refusal::new(
                Code::Timeout,
                format!("the robot does not say that it stands, {seconds} s after it was stopped"),
            )
        };
        for (asked, since) in std::mem::take(&mut self.stoppers) {
            match &stands {
                Some(stands) => self.reply(asked, stands.clone()),
                None if now.saturating_duration_since(since) >= STOPPED_WITHIN => {
                    self.reply(asked, Err(late()));
                }
                None => self.stoppers.push((asked, since)),
            }
        }
    }

    /// Whether a run was given up, and the robot program has not spoken since.
    fn is_in_doubt(&self) -> bool {
        let spoke = self.program.as_ref().map(|(_, at)| *at);
        self.given_up.is_some_and(|given_up| spoke.is_none_or(|spoke| spoke <= given_up))
    }

    /// From now on the robot program is to end the run, unless it is told to already.
    pub(super) fn end_by(&mut self, instruction: Instruction, now: Instant) {
        if let State::Running(running) = &mut self.state
            && running.ended_by.is_none()
        {
            running.ended_by = Some(instruction.clone());
            self.instruct(instruction, Purpose::End, now);
        }
    }

    /// Tells the robot program to end something, unless it is being told so.
    pub(super) fn tell_end(&mut self, instruction: Instruction, now: Instant) {
        if !self.instructions.purposes().any(|purpose| matches!(purpose, Purpose::End)) {
            self.instruct(instruction, Purpose::End, now);
        }
    }

    /// How a run that the robot program is busy with is to be ended, if it is.
    pub(super) fn end_of(&self, run: RunId, state: DriveState) -> Option<Instruction> {
        match &self.state {
            State::Running(running) if running.run == run => running.ended_by.clone(),
            // Nobody feeds it any more.
            _ if state == DriveState::RunningTrajectory => Some(Instruction::EndTrajectory { run }),
            // It was given up, and has begun all the same.
            _ if self.is_own(run) => Some(Instruction::Stop),
            _ => (!self.stoppers.is_empty()).then_some(Instruction::Stop),
        }
    }

    /// Whether this drive has given a run that number.
    fn is_own(&self, run: RunId) -> bool {
        run.wrapping_sub(self.first_run) < self.next_run.wrapping_sub(self.first_run)
    }
}
