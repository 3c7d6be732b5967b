//! Whether the FRI thread answers in time, by its own account.

use std::{
    sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    time::Duration,
};

/// How punctual a drive has been so far, by its own account. How long an answer takes altogether, only
/// the controller can tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Punctuality {
    /// Messages of the controller that the drive has read.
    pub received: u64,
    /// Answers to them.
    pub answered: u64,
    /// Answers that left when the next message had come in already: these cycles were lost by the drive,
    /// or by the machine that did not let it run.
    pub behind: u64,
    /// Messages that did not go on with the ones before, or came from elsewhere: nothing was made of them.
    pub ignored: u64,
    /// Longest time from reading a message to sending its answer.
    pub slowest: Duration,
    /// Whether the system lets the thread that answers run ahead of ordinary ones.
    pub real_time: bool,
}

/// Where the FRI thread counts, and others look.
#[derive(Debug, Default)]
pub(super) struct Account {
    received: AtomicU64,
    answered: AtomicU64,
    behind: AtomicU64,
    ignored: AtomicU64,
    slowest_ns: AtomicU64,
    real_time: AtomicBool,
}

impl Account {
    pub(super) fn raised(&self, real_time: bool) {
        self.real_time.store(real_time, Relaxed);
    }

    pub(super) fn received(&self) {
        self.received.fetch_add(1, Relaxed);
    }

    /// So many messages have been ignored up to now.
    pub(super) fn ignored(&self, count: u64) {
        self.ignored.store(count, Relaxed);
    }

    /// An answer has left, so long after its message was read.
    pub(super) fn answered(&self, after: Duration, is_behind: bool) {
        self.answered.fetch_add(1, Relaxed);
        self.behind.fetch_add(u64::from(is_behind), Relaxed);
        let after_ns = u64::try_from(after.as_nanos()).unwrap_or(u64::MAX);
        self.slowest_ns.fetch_max(after_ns, Relaxed);
    }

    pub(super) fn read(&self) -> Punctuality {
        Punctuality {
            received: self.received.load(Relaxed),
            answered: self.answered.load(Relaxed),
            behind: self.behind.load(Relaxed),
            ignored: self.ignored.load(Relaxed),
            slowest: Duration::from_nanos(self.slowest_ns.load(Relaxed)),
            real_time: self.real_time.load(Relaxed),
        }
    }
}
