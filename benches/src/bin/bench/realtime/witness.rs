//! Processes that detect stalls of the machine.

use std::{
    path::Path,
    process::{Command, Stdio},
    sync::{Arc, Mutex, PoisonError},
    thread,
    time::{Duration, Instant},
};

use iiwasim_benches::Result;

use super::{
    clock::SystemClock,
    part::{Part, serve},
};

/// Interval, in us of the system clock.
pub(crate) type Section = [i64; 2];

/// Merges overlapping intervals.
pub(crate) fn joined(mut sections: Vec<Section>) -> Vec<Section> {
    sections.sort_unstable();
    let mut joined: Vec<Section> = Vec::new();
    for [from, to] in sections {
        match joined.last_mut() {
            Some(last) if last[1] >= from => last[1] = last[1].max(to),
            _ => joined.push([from, to]),
        }
    }
    joined
}

/// Starts a witness on each core; `None` if this is not permitted.
pub(crate) fn witnesses(this: &Path) -> Result<Option<Vec<Part>>> {
    // Above the priorities of drive and cabinet.
    const PRIORITY: &str = "60";
    let cores = thread::available_parallelism()?.get();
    let on = |core: usize| {
        let mut command = Command::new("chrt");
        command.args(["--fifo", PRIORITY, "taskset", "--cpu-list", &core.to_string()]);
        Part::start(command.arg(this).args(["realtime", "--part", "witness"]).stderr(Stdio::null()))
    };
    Ok((0..cores).map(on).collect::<Result<Vec<_>>>().ok())
}

/// Wakes periodically, and reports missed wake-ups, in us of the system clock.
pub(crate) fn be_witness() -> Result<()> {
    const EVERY: Duration = Duration::from_micros(250);
    /// Delay of a wake-up that only a stall explains.
    const STILL: Duration = Duration::from_micros(100);
    let still = Arc::new(Mutex::new(Vec::new()));
    let seen = Arc::clone(&still);
    thread::spawn(move || {
        let mut due = Instant::now() + EVERY;
        loop {
            thread::sleep(due.saturating_duration_since(Instant::now()));
            let awake = Instant::now();
            if awake.duration_since(due) > STILL {
                let clock = SystemClock::new();
                let section: Section = [clock.us(due), clock.us(awake)];
                seen.lock().unwrap_or_else(PoisonError::into_inner).push(section);
                due = awake;
            }
            due += EVERY;
        }
    });
    serve(|| still.lock().unwrap_or_else(PoisonError::into_inner).clone())
}
