//! Latency statistics of the FRI thread.

use std::{
    sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    time::Duration,
};

/// Latency statistics of the drive's answers to the controller, as measured by the drive. They
/// exclude the network, unlike the latency that the simulated cabinet measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct AnswerLatency {
    /// Messages received from the controller.
    pub received: u64,
    /// Answers sent.
    pub answered: u64,
    /// Answers sent after the next message had arrived: cycles lost by the drive or by the
    /// scheduler of the machine.
    pub behind: u64,
    /// Messages ignored as implausible or from another address.
    pub ignored: u64,
    /// Longest time from receiving a message to sending its answer.
    pub slowest: Duration,
    /// `true` if the answering thread has real-time priority.
    pub real_time: bool,
}

/// Counters of the FRI thread, readable by other threads.
#[derive(Debug, Default)]
pub(super) struct LatencyRecorder {
    received: AtomicU64,
    answered: AtomicU64,
    behind: AtomicU64,
    ignored: AtomicU64,
    slowest_ns: AtomicU64,
    real_time: AtomicBool,
}

impl LatencyRecorder {
    pub(super) fn raised(&self, real_time: bool) {
        self.real_time.store(real_time, Relaxed);
    }

    pub(super) fn received(&self) {
        self.received.fetch_add(1, Relaxed);
    }

    /// Sets the number of ignored messages.
    pub(super) fn ignored(&self, count: u64) {
        self.ignored.store(count, Relaxed);
    }

    /// Records an answer, sent `after` the reception of its message.
    pub(super) fn answered(&self, after: Duration, is_behind: bool) {
        self.answered.fetch_add(1, Relaxed);
        self.behind.fetch_add(u64::from(is_behind), Relaxed);
        let after_ns = u64::try_from(after.as_nanos()).unwrap_or(u64::MAX);
        self.slowest_ns.fetch_max(after_ns, Relaxed);
    }

    pub(super) fn read(&self) -> AnswerLatency {
        // Not a consistent snapshot: these are independent statistics.
        AnswerLatency {
            received: self.received.load(Relaxed),
            answered: self.answered.load(Relaxed),
            behind: self.behind.load(Relaxed),
            ignored: self.ignored.load(Relaxed),
            slowest: Duration::from_nanos(self.slowest_ns.load(Relaxed)),
            real_time: self.real_time.load(Relaxed),
        }
    }
}
