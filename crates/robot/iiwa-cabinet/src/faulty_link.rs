//! The link to the FRI client, with simulated faults.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use crate::{config::Faults, latency::LatencyMonitor};

/// The link, and its datagram statistics.
pub(crate) struct FaultyLink {
    pub(crate) faults: Faults,
    random: fastrand::Rng,
    /// Messages of the last cycles, kept for a delay; empty for cycles without a message.
    delayed: VecDeque<Vec<u8>>,
    /// Time until which all datagrams are dropped.
    silent_until: Option<Instant>,
    /// Number of messages to be sent.
    pub(crate) cycles: u64,
    /// Number of cycles in which the machine delayed the clock.
    pub(crate) delayed_cycles: u64,
    pub(crate) real_time: bool,
    pub(crate) monitor: LatencyMonitor,
}

impl FaultyLink {
    pub(crate) fn new(faults: Faults, period: Duration) -> Self {
        Self {
            faults,
            random: fastrand::Rng::with_seed(2),
            delayed: VecDeque::new(),
            silent_until: None,
            cycles: 0,
            delayed_cycles: 0,
            real_time: false,
            monitor: LatencyMonitor::new(period),
        }
    }

    /// Drops all datagrams for `duration`.
    pub(crate) fn silence(&mut self, duration: Duration) {
        self.silent_until = Some(Instant::now() + duration);
    }

    /// Returns the datagram that leaves the link in this cycle, in which `message` enters the link.
    pub(crate) fn send(&mut self, message: Option<&[u8]>) -> Option<Vec<u8>> {
        self.cycles += u64::from(message.is_some());
        self.delayed.push_back(message.map(<[u8]>::to_vec).unwrap_or_default());
        let delay = self.faults.delay_cycles as usize;
        if self.delayed.len() <= delay {
            return None;
        }
        let datagram = self.delayed.drain(..self.delayed.len() - delay).next_back()?;
        if datagram.is_empty() || self.loses() {
            return None;
        }
        self.monitor.sent(&datagram, Instant::now());
        Some(datagram)
    }

    /// Returns true if a received answer passes the link.
    pub(crate) fn receive(&mut self, datagram: &[u8], now: Instant) -> bool {
        if self.loses() {
            return false;
        }
        self.monitor.answered(datagram, now);
        true
    }

    fn loses(&mut self) -> bool {
        self.silent_until.is_some_and(|until| Instant::now() < until)
            || (self.faults.packet_loss > 0.0 && self.random.f64() < self.faults.packet_loss)
    }
}
