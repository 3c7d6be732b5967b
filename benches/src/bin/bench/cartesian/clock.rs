//! Times of anything that can be done again.

use std::{
    hint::black_box,
    time::{Duration, Instant},
};

use iiwasim_benches::Result;

/// It is done so many times at least.
const LEAST_RUNS: u32 = 20;
/// And no more often once it took this long in all.
const LONG: Duration = Duration::from_millis(60);

/// The time of the fastest run of `work`, in s.
pub(crate) fn fastest_s<T>(work: impl Fn() -> Result<T>) -> Result<f64> {
    let began = Instant::now();
    let (mut runs, mut fastest) = (0, Duration::MAX);
    while runs < LEAST_RUNS || began.elapsed() < LONG {
        let start = Instant::now();
        let made = black_box(work()?);
        fastest = fastest.min(start.elapsed());
        drop(made);
        runs += 1;
    }
    Ok(fastest.as_secs_f64())
}

/// The value that so many percent of all are below or equal to; `sorted` rises and is not empty.
pub(crate) fn quantile(sorted: &[f64], percent: usize) -> f64 {
    sorted[((sorted.len() - 1) * percent + 50) / 100]
}
