//! Real-time tests on machines with other load.
//!
//! A set-point that leaves some milliseconds late changes the motion of the arm through no fault of
//! the tested code. If a test fails while the machine has delayed its threads, it is repeated once
//! the machine is quiet; a failure without such delays is final.

use std::{
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

/// Wake-up delay above which a thread counts as delayed by the machine: the shortest cycle of the
/// tests. A few answers that are later make the quality of a connection too low for commanding.
const HELD_UP: Duration = Duration::from_millis(1);

/// Maximum number of attempts.
const ATTEMPTS: usize = 12;

/// Required quiet time before the next attempt, and the time limit for reaching it.
const CALM: Duration = Duration::from_millis(500);
const WAIT_FOR_CALM: Duration = Duration::from_secs(20);

/// Runs the test; repeats it after failures during which the machine delayed threads.
///
/// # Panics
///
/// Panics if the test fails without such delays, or in every attempt.
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

/// Thread that sleeps repeatedly, and records the wake-up delays.
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

    /// Returns the longest delay.
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
