//! The line to the client of FRI, with its faults.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use super::{Faults, latency::Watch};

/// What is on its way to the client, and what has come back.
pub(super) struct Line {
    pub(super) faults: Faults,
    random: fastrand::Rng,
    /// Messages of the last cycles, which a delay keeps back; empty where there was none.
    kept_back: VecDeque<Vec<u8>>,
    /// Up to when nothing gets through.
    silent_until: Option<Instant>,
    /// Messages that were to be sent.
    pub(super) cycles: u64,
    /// Cycles in which this machine held up the clock.
    pub(super) held_up: u64,
    pub(super) real_time: bool,
    pub(super) watch: Watch,
}

impl Line {
    pub(super) fn new(faults: Faults, period: Duration) -> Self {
        Self {
            faults,
            random: fastrand::Rng::with_seed(2),
            kept_back: VecDeque::new(),
            silent_until: None,
            cycles: 0,
            held_up: 0,
            real_time: false,
            watch: Watch::new(period),
        }
    }

    /// Lets nothing through for so long.
    pub(super) fn silence(&mut self, duration: Duration) {
        self.silent_until = Some(Instant::now() + duration);
    }

    /// What leaves the line in this cycle when `message` enters it.
    pub(super) fn send(&mut self, message: Option<&[u8]>) -> Option<Vec<u8>> {
        self.cycles += u64::from(message.is_some());
        self.kept_back.push_back(message.map(<[u8]>::to_vec).unwrap_or_default());
        let delay = self.faults.delay_cycles as usize;
        if self.kept_back.len() <= delay {
            return None;
        }
        let datagram = self.kept_back.drain(..self.kept_back.len() - delay).next_back()?;
        if datagram.is_empty() || self.loses() {
            return None;
        }
        self.watch.sent(&datagram, Instant::now());
        Some(datagram)
    }

    /// Whether an answer that has come gets through.
    pub(super) fn receive(&mut self, datagram: &[u8], now: Instant) -> bool {
        if self.loses() {
            return false;
        }
        self.watch.answered(datagram, now);
        true
    }

    fn loses(&mut self) -> bool {
        self.silent_until.is_some_and(|until| Instant::now() < until)
            || (self.faults.packet_loss > 0.0 && self.random.f64() < self.faults.packet_loss)
    }
}
