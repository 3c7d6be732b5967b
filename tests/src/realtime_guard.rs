//! Tests of what happens in real time, on machines that others use as well.
//!
//! A set-point that leaves some milliseconds late changes where the arm goes, and nobody but the machine
//! is to blame. A test that fails while the machine held its threads up is judged anew, once the machine
//! is calm; one that fails while nothing was held up has failed.

use std::{
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

/// A thread that wakes up so much later than it asked for has been held up.
const HELD_UP: Duration = Duration::from_millis(2);

/// How often a test is judged at most.
const ATTEMPTS: usize = 12;

/// How long the machine is to be calm before the next attempt, and how long that is waited for.
const CALM: Duration = Duration::from_millis(500);
const WAIT_FOR_CALM: Duration = Duration::from_secs(20);

/// Runs the test; again, if it fails while the machine held up threads.
///
/// # Panics
///
/// If the test does, on a machine that lets it run, or in every attempt.
pub fn in_real_time(test: impl Fn()) {
    for attempt in 1.. {
        let canary = Canary::start();
        let Err(failure) = catch_unwind(AssertUnwindSafe(&test)) else { return };
        let held_up = canary.end();
        if held_up < HELD_UP || attempt == ATTEMPTS {
            resume_unwind(failure);
        }
        wait_for_calm();
    }
}

fn wait_for_calm() {
    let since = Instant::now();
    while since.elapsed() < WAIT_FOR_CALM {
        let canary = Canary::start();
        thread::sleep(CALM);
        if canary.end() < HELD_UP {
            return;
        }
    }
}

/// A thread that sleeps again and again, and notes how much too long.
struct Canary {
    shared: Arc<Noted>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Noted {
    over: AtomicBool,
    longest_ns: AtomicU64,
}

impl Canary {
    fn start() -> Self {
        let shared = Arc::new(Noted::default());
        let noted = Arc::clone(&shared);
        let thread = thread::spawn(move || {
            let nap = Duration::from_millis(1);
            while !noted.over.load(Relaxed) {
                let since = Instant::now();
                thread::sleep(nap);
                let late = since.elapsed().saturating_sub(nap);
                noted
                    .longest_ns
                    .fetch_max(u64::try_from(late.as_nanos()).unwrap_or(u64::MAX), Relaxed);
            }
        });
        Self { shared, thread: Some(thread) }
    }

    /// The longest time by which it was held up.
    fn end(mut self) -> Duration {
        self.shared.over.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        Duration::from_nanos(self.shared.longest_ns.load(Relaxed))
    }
}

impl Drop for Canary {
    fn drop(&mut self) {
        self.shared.over.store(true, Relaxed);
    }
}
