//! Instructions to the robot program: one after the other, each with its number and its time.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use crate::robot_program::Instruction;

/// Most instructions that wait for those before them, of those that may be refused.
const MOST_WAITING: usize = 32;

/// How long an instruction may take to be acknowledged.
pub(super) const ACKNOWLEDGED_WITHIN: Duration = Duration::from_secs(2);

/// How long motions may take to be acknowledged: they are planned before.
const PLANNED_WITHIN: Duration = Duration::from_mins(1);

/// What waits and what is on its way. `P` says what an instruction is for.
pub(super) struct Instructions<P> {
    seq: u64,
    waiting: VecDeque<Waiting<P>>,
    in_flight: Option<InFlight<P>>,
}

struct Waiting<P> {
    instruction: Instruction,
    purpose: P,
    since: Instant,
}

struct InFlight<P> {
    seq: u64,
    until: Instant,
    purpose: P,
}

impl<P> Instructions<P> {
    pub(super) fn new() -> Self {
        Self { seq: 0, waiting: VecDeque::new(), in_flight: None }
    }

    /// Whether too many wait already for one more that may be refused.
    pub(super) fn is_full(&self) -> bool {
        self.waiting.len() >= MOST_WAITING
    }

    pub(super) fn add(&mut self, instruction: Instruction, purpose: P, now: Instant) {
        self.waiting.push_back(Waiting { instruction, purpose, since: now });
    }

    /// The next one to be sent, if none is on its way.
    pub(super) fn next(&mut self, now: Instant) -> Option<String> {
        if self.in_flight.is_some() {
            return None;
        }
        let Waiting { instruction, purpose, .. } = self.waiting.pop_front()?;
        self.seq += 1;
        let within = match instruction {
            Instruction::RunMotions { .. } => PLANNED_WITHIN,
            _ => ACKNOWLEDGED_WITHIN,
        };
        self.in_flight = Some(InFlight { seq: self.seq, until: now + within, purpose });
        Some(instruction.to_json(self.seq))
    }

    /// The one of this number has been acknowledged.
    pub(super) fn acknowledged(&mut self, seq: Option<u64>) -> Option<P> {
        self.in_flight.take_if(|it| seq == Some(it.seq)).map(|it| it.purpose)
    }

    /// The one that is on its way, if it is for such a purpose, needs no acknowledgement any more.
    pub(super) fn settle(&mut self, is_settled: impl Fn(&P) -> bool) -> Option<P> {
        self.in_flight.take_if(|it| is_settled(&it.purpose)).map(|it| it.purpose)
    }

    /// The one on its way, if it has taken too long.
    pub(super) fn expired(&mut self, now: Instant) -> Option<P> {
        self.in_flight.take_if(|it| it.until <= now).map(|it| it.purpose)
    }

    /// Takes those out that wait, for such a purpose, since such a time.
    pub(super) fn withdraw(&mut self, mut is_withdrawn: impl FnMut(&P, Instant) -> bool) -> Vec<P> {
        let mut withdrawn = Vec::new();
        for it in std::mem::take(&mut self.waiting) {
            if is_withdrawn(&it.purpose, it.since) {
                withdrawn.push(it.purpose);
            } else {
                self.waiting.push_back(it);
            }
        }
        withdrawn
    }

    /// What those that wait or are on their way are for.
    pub(super) fn purposes(&self) -> impl Iterator<Item = &P> {
        let in_flight = self.in_flight.iter().map(|it| &it.purpose);
        in_flight.chain(self.waiting.iter().map(|it| &it.purpose))
    }
}
