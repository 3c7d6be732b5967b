//! Progress bars on standard error.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Progress bar on standard error, if that is a terminal, once the work takes longer than
/// [`Self::SHORT`].
pub(crate) struct Progress {
    since: Instant,
    steps: u64,
    done: u64,
    look: &'static str,
    /// Remaining time, if known.
    left: String,
    bar: Option<ProgressBar>,
}

impl Progress {
    const SHORT: Duration = Duration::from_millis(500);

    /// Progress of planning one program.
    pub(crate) fn of_program() -> Self {
        Self::new(1000, "planning {wide_bar} {percent} %, {eta} left")
    }

    /// Progress of planning many programs.
    pub(crate) fn of_programs(count: usize) -> Self {
        Self::new(count as u64, "planning {wide_bar} {pos} of {len} programs, {eta} left")
    }

    /// Progress of a search, with an unknown number of plans.
    #[cfg(feature = "optimise")]
    pub(crate) fn of_search() -> Self {
        Self::new(0, "{spinner} {pos} plans compared, {elapsed}")
    }

    fn new(steps: u64, look: &'static str) -> Self {
        Self { since: Instant::now(), steps, done: 0, look, left: String::new(), bar: None }
    }

    /// Shows the completed share of the work, 0 to 1.
    pub(crate) fn show_share(&mut self, share: f64) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1000")]
        self.show((share * self.steps as f64) as u64);
    }

    /// Shows the number of completed steps.
    pub(crate) fn show(&mut self, done: u64) {
        self.done = done;
        self.alive();
    }

    /// Shows that the work continues.
    pub(crate) fn alive(&mut self) {
        if self.bar.is_none() && self.since.elapsed() < Self::SHORT {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let style = ProgressStyle::with_template(self.look);
            let bar = ProgressBar::with_draw_target(Some(self.steps), ProgressDrawTarget::stderr());
            bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        bar.set_message(self.left.clone());
        bar.set_position(self.done);
    }

    /// Prints while the bar is hidden.
    pub(crate) fn aside<T>(&self, print: impl FnOnce() -> T) -> T {
        match &self.bar {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }

    /// Removes the bar.
    pub(crate) fn clear(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(feature = "live")]
impl Progress {
    /// Progress of a run of the robot; see [`Self::show_time`].
    pub(crate) fn of_run() -> Self {
        Self::new(1000, "running {wide_bar} {percent} %, {msg} left")
    }

    /// Progress of a motion to the start of a program; see [`Self::show_time`].
    pub(crate) fn of_approach() -> Self {
        Self::new(1000, "moving to the start {wide_bar} {percent} %, {msg} left")
    }

    /// Progress of the programs of an experiment.
    pub(crate) fn of_experiment(count: usize) -> Self {
        Self::new(count as u64, "running {wide_bar} {pos} of {len} programs, {eta} left")
    }

    /// Progress of a recording, in samples.
    pub(crate) fn of_recording() -> Self {
        Self::new(u64::MAX, "recording: {pos} samples in {elapsed}; Ctrl-C ends it")
    }

    /// Shows the progress of a motion of known duration, both in s.
    pub(crate) fn show_time(&mut self, t_s: f64, whole_s: f64) {
        self.left = format!("{:.0} s", (whole_s - t_s).max(0.0).ceil());
        self.show_share((t_s / whole_s).clamp(0.0, 1.0));
    }
}
