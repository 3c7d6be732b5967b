//! Timing of repeatable work.

use std::{
    hint::black_box,
    time::{Duration, Instant},
};

use iiwasim_benches::Result;

/// Minimum number of runs.
const MIN_RUNS: u32 = 20;
/// Total time after which no more runs are started.
const LONG: Duration = Duration::from_millis(60);

/// Returns the time of the fastest run of `work`, in s.
pub(crate) fn fastest_s<T>(work: impl Fn() -> Result<T>) -> Result<f64> {
    let began = Instant::now();
    let (mut runs, mut fastest) = (0, Duration::MAX);
    while runs < MIN_RUNS || began.elapsed() < LONG {
        let start = Instant::now();
        let made = black_box(work()?);
        fastest = fastest.min(start.elapsed());
        drop(made);
        runs += 1;
    }
    Ok(fastest.as_secs_f64())
}

/// Returns the quantile at `percent`; `sorted` is in ascending order and not empty.
pub(crate) fn quantile(sorted: &[f64], percent: usize) -> f64 {
    sorted[((sorted.len() - 1) * percent + 50) / 100]
}
