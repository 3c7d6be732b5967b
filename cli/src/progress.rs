//! How far the work is, on standard error.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A progress bar on standard error, if that is a terminal, once the work turns out to be long.
pub(crate) struct Progress {
    since: Instant,
    steps: u64,
    done: u64,
    look: &'static str,
    bar: Option<ProgressBar>,
}

impl Progress {
    const SHORT: Duration = Duration::from_millis(500);

    /// Of the work on one program, of which shares are told.
    pub(crate) fn of_program() -> Self {
        Self::new(1000, "planning {wide_bar} {percent} %, {eta} left")
    }

    /// Of the work on many programs, of which the number that is done is told.
    pub(crate) fn of_programs(count: usize) -> Self {
        Self::new(count as u64, "planning {wide_bar} {pos} of {len} programs, {eta} left")
    }

    /// Of a run of the robot, of which shares are told.
    pub(crate) fn of_run() -> Self {
        Self::new(1000, "running {wide_bar} {percent} %, {eta} left")
    }

    /// Of an experiment's programs, of which the number that has run is told.
    pub(crate) fn of_experiment(count: usize) -> Self {
        Self::new(count as u64, "running {wide_bar} {pos} of {len} programs, {eta} left")
    }

    /// Of a recording, of which the number of samples is told.
    pub(crate) fn of_recording() -> Self {
        Self::new(u64::MAX, "recording: {pos} samples in {elapsed}; Ctrl-C ends it")
    }

    fn new(steps: u64, look: &'static str) -> Self {
        Self { since: Instant::now(), steps, done: 0, look, bar: None }
    }

    /// A share of the work is done, 0 to 1.
    pub(crate) fn show_share(&mut self, share: f64) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1000")]
        self.show((share * self.steps as f64) as u64);
    }

    /// So many steps are done.
    pub(crate) fn show(&mut self, done: u64) {
        self.done = done;
        self.alive();
    }

    /// The work goes on.
    pub(crate) fn alive(&mut self) {
        if self.bar.is_none() && self.since.elapsed() < Self::SHORT {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let style = ProgressStyle::with_template(self.look);
            let bar = ProgressBar::with_draw_target(Some(self.steps), ProgressDrawTarget::stderr());
            bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        bar.set_position(self.done);
    }

    /// Says something without the bar in between.
    pub(crate) fn aside<T>(&self, say: impl FnOnce() -> T) -> T {
        match &self.bar {
            Some(bar) => bar.suspend(say),
            None => say(),
        }
    }

    /// Takes the bar away.
    pub(crate) fn clear(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
