//! Stops: a run that has not begun is withdrawn, a run that has begun is stopped, and the reply is
//! sent once the robot is known to be at rest.

use std::time::{Duration, Instant};

use iiwa_link::{
    message::{Code, DriveState, Refusal},
    robot_program::{Instruction, RunId},
};

use super::state::{Dispatcher, DispatcherOutput, Purpose, Requester, RunStage};
use crate::drive::{events::FriCommand, run::RunProgress};

/// Time-out of a stop: clients wait five seconds for the reply.
const STOP_TIMEOUT: Duration = Duration::from_secs(4);

impl<C> Dispatcher<C> {
    pub(super) fn serve_stop(&mut self, requester: Requester<C>, now: Instant) {
        // Also withdraws runs whose requests are still arriving: see `check_free`.
        self.stopped = Some(now);
        self.stop("stopped on request", now);
        // A run of a previous drive, or a robot that is not known to be at rest.
        if matches!(self.stage, RunStage::Idle)
            && self.program_at(now).is_none_or(|program| program.state != DriveState::Idle)
        {
            self.instruct_end(Instruction::Stop, now);
        }
        self.stoppers.push((requester, now));
        self.reply_to_stoppers(now);
    }

    /// Handles the disconnection of a client: its queries are withdrawn, and so is its run unless
    /// the run has begun.
    pub(in crate::drive) fn disconnected(&mut self, is_client: impl Fn(&C) -> bool, now: Instant) {
        let of_client = |purpose: &Purpose<C>, _| match purpose {
            Purpose::Query(requester, _) => is_client(&requester.client),
            _ => false,
        };
        self.instructions.withdraw(of_client);
        self.stoppers.retain(|(requester, _)| !is_client(&requester.client));
        let waiting = match &self.stage {
            RunStage::Checking(_, requester) => Some(&requester.client),
            RunStage::Running(running) if running.phase != RunProgress::Begun => {
                Some(&running.requester.client)
            }
            _ => None,
        };
        if waiting.is_some_and(is_client) {
            self.stop("its client has disconnected", now);
        }
    }

    /// Withdraws or stops the current run.
    fn stop(&mut self, reason: &str, now: Instant) {
        let before = || Refusal::robot(format!("{reason}, before the run began"));
        match &self.stage {
            RunStage::Idle => {}
            RunStage::Checking(..) => {
                if let RunStage::Checking(run, requester) =
                    std::mem::replace(&mut self.stage, RunStage::Idle)
                {
                    self.withdrawn.push((run, requester, before()));
                }
            }
            // Not instructed to begin, so the robot program discards the motions by itself.
            RunStage::Running(running) if running.phase == RunProgress::Planning => {
                let run = running.run;
                self.fail(run, before(), now);
            }
            RunStage::Running(running) if running.kind == DriveState::RunningTrajectory => {
                // On its path, by set-points: the cabinet does not know the path.
                self.outputs.push(DispatcherOutput::Fri(FriCommand::Stop));
            }
            RunStage::Running(_) => self.end_by(Instruction::Stop, now),
        }
    }

    /// Replies to stop requests once the robot is known to be at rest.
    pub(super) fn reply_to_stoppers(&mut self, now: Instant) {
        let result = match (&self.stage, self.program_at(now)) {
            (RunStage::Running(_), _) => None,
            (_, None) => Some(Err(Refusal::robot(
                "the robot program does not answer: it is unknown whether the arm is at rest",
            ))),
            (_, Some(program)) if program.state != DriveState::Idle => None,
            // The robot program may have begun an abandoned run.
            _ if self.is_in_doubt() => None,
            _ => Some(Ok(None)),
        };
        let overdue = || {
            let seconds = STOP_TIMEOUT.as_secs();
            Refusal::new(
                Code::Timeout,
                format!("the robot has not reported that the arm is at rest within {seconds} s"),
            )
        };
        for (requester, since) in std::mem::take(&mut self.stoppers) {
            match &result {
                Some(result) => self.reply(requester, result.clone()),
                None if now.saturating_duration_since(since) >= STOP_TIMEOUT => {
                    self.reply(requester, Err(overdue()));
                }
                None => self.stoppers.push((requester, since)),
            }
        }
    }

    /// Returns true if a run was abandoned and the robot program has not sent its state since.
    fn is_in_doubt(&self) -> bool {
        let reported = self.program.as_ref().map(|(_, instant)| *instant);
        self.abandoned.is_some_and(|abandoned| reported.is_none_or(|instant| instant <= abandoned))
    }

    /// Instructs the robot program to end the run, unless it was instructed before.
    pub(super) fn end_by(&mut self, instruction: Instruction, now: Instant) {
        if let RunStage::Running(running) = &mut self.stage
            && running.end_instruction.is_none()
        {
            running.end_instruction = Some(instruction.clone());
            self.instruct(instruction, Purpose::End, now);
        }
    }

    /// Sends an instruction to end a run, unless such an instruction is pending.
    pub(super) fn instruct_end(&mut self, instruction: Instruction, now: Instant) {
        if !self.instructions.purposes().any(|purpose| matches!(purpose, Purpose::End)) {
            self.instruct(instruction, Purpose::End, now);
        }
    }

    /// Returns the instruction that ends a run reported by the robot program, if this run must end.
    pub(super) fn end_of(&self, run: RunId, state: DriveState) -> Option<Instruction> {
        match &self.stage {
            RunStage::Running(running) if running.run == run => running.end_instruction.clone(),
            // A trajectory without set-points.
            _ if state == DriveState::RunningTrajectory => Some(Instruction::EndTrajectory { run }),
            // An abandoned run that has begun after all.
            _ if self.is_of_this_drive(run) => Some(Instruction::Stop),
            _ => (!self.stoppers.is_empty()).then_some(Instruction::Stop),
        }
    }

    /// Returns true if this drive has numbered the run.
    fn is_of_this_drive(&self, run: RunId) -> bool {
        run.wrapping_sub(self.first_run) < self.next_run.wrapping_sub(self.first_run)
    }
}
