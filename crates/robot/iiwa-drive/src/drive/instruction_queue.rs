//! Queue of instructions to the robot program: at most one is pending, each has a number and a
//! deadline.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use iiwa_link::robot_program::Instruction;

/// Backlog at which further client queries are refused.
const QUOTA: usize = 32;

/// Time-out of acknowledgements.
pub(super) const ACKNOWLEDGE_TIMEOUT: Duration = Duration::from_secs(2);

/// Time-out of the acknowledgement of motions, which is sent after planning.
const PLANNING_TIMEOUT: Duration = Duration::from_mins(1);

/// The backlog and the pending instruction. `P` is the purpose of an instruction.
pub(super) struct InstructionQueue<P> {
    seq: u64,
    backlog: VecDeque<QueuedInstruction<P>>,
    pending: Option<PendingInstruction<P>>,
}

struct QueuedInstruction<P> {
    instruction: Instruction,
    purpose: P,
    since: Instant,
}

struct PendingInstruction<P> {
    seq: u64,
    deadline: Instant,
    purpose: P,
}

impl<P> InstructionQueue<P> {
    pub(super) fn new() -> Self {
        Self { seq: 0, backlog: VecDeque::new(), pending: None }
    }

    /// Returns true if the quota is exhausted.
    pub(super) fn is_full(&self) -> bool {
        self.backlog.len() >= QUOTA
    }

    pub(super) fn add(&mut self, instruction: Instruction, purpose: P, now: Instant) {
        self.backlog.push_back(QueuedInstruction { instruction, purpose, since: now });
    }

    /// Returns the next instruction to be sent, as JSON, if none is pending.
    pub(super) fn next(&mut self, now: Instant) -> Option<String> {
        if self.pending.is_some() {
            return None;
        }
        let QueuedInstruction { instruction, purpose, .. } = self.backlog.pop_front()?;
        self.seq += 1;
        let within = match instruction {
            Instruction::RunMotions { .. } => PLANNING_TIMEOUT,
            _ => ACKNOWLEDGE_TIMEOUT,
        };
        self.pending = Some(PendingInstruction { seq: self.seq, deadline: now + within, purpose });
        Some(instruction.to_json(self.seq))
    }

    /// Completes the pending instruction if it has the number `seq`.
    pub(super) fn acknowledged(&mut self, seq: Option<u64>) -> Option<P> {
        self.pending.take_if(|it| seq == Some(it.seq)).map(|it| it.purpose)
    }

    /// Completes the pending instruction if its purpose is resolved without an acknowledgement.
    pub(super) fn resolve(&mut self, is_resolved: impl Fn(&P) -> bool) -> Option<P> {
        self.pending.take_if(|it| is_resolved(&it.purpose)).map(|it| it.purpose)
    }

    /// Removes the pending instruction if its deadline has passed.
    pub(super) fn expired(&mut self, now: Instant) -> Option<P> {
        self.pending.take_if(|it| it.deadline <= now).map(|it| it.purpose)
    }

    /// Removes instructions from the backlog by purpose and queueing time.
    pub(super) fn withdraw(&mut self, mut is_withdrawn: impl FnMut(&P, Instant) -> bool) -> Vec<P> {
        let mut withdrawn = Vec::new();
        for it in std::mem::take(&mut self.backlog) {
            if is_withdrawn(&it.purpose, it.since) {
                withdrawn.push(it.purpose);
            } else {
                self.backlog.push_back(it);
            }
        }
        withdrawn
    }

    /// Returns the purposes of all instructions, pending and in the backlog.
    pub(super) fn purposes(&self) -> impl Iterator<Item = &P> {
        let pending = self.pending.iter().map(|it| &it.purpose);
        pending.chain(self.backlog.iter().map(|it| &it.purpose))
    }
}
