//! How a run went beside its plan, as JSON and in words.

use std::{fmt::Write as _, path::Path};

use serde::Serialize;

/// How a run went beside its plan. As JSON, this is the object of `iiwasim run --json`.
#[derive(Clone, Debug, Serialize)]
pub struct RunReport {
    planned_cycle_time_s: f64,
    measured_cycle_time_s: Option<f64>,
    error_s: Option<f64>,
    error_percent: Option<f64>,
    /// When a run that broke off did so.
    ended_after_s: Option<f64>,
    samples: usize,
    output: Option<String>,
}

impl RunReport {
    /// Of a run whose plan takes `planned_s`, and that took or ended after `measured_s`; of its samples,
    /// which are in a file if they were written.
    #[must_use]
    pub fn new(
        planned_s: f64,
        measured_s: Option<f64>,
        complete: bool,
        samples: usize,
        file: Option<&Path>,
    ) -> Self {
        let ended_after_s = measured_s.filter(|_| !complete);
        let measured_s = measured_s.filter(|_| complete);
        // As Eq. 40 of the thesis has it: of the measured time.
        let error_s = measured_s.map(|measured_s| planned_s - measured_s);
        Self {
            planned_cycle_time_s: planned_s,
            measured_cycle_time_s: measured_s,
            error_s,
            error_percent: error_s
                .zip(measured_s)
                .map(|(error, measured)| 100.0 * error / measured),
            ended_after_s,
            samples,
            output: file.map(|file| file.display().to_string()),
        }
    }

    /// In words.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        let planned_s = self.planned_cycle_time_s;
        if let (Some(measured_s), Some(error_s), Some(percent)) =
            (self.measured_cycle_time_s, self.error_s, self.error_percent)
        {
            let _ = writeln!(
                text,
                "Measured   {measured_s:.3} s, planned {planned_s:.3} s: the plan is off by \
                 {error_s:+.3} s, {percent:+.2} %"
            );
        }
        if let Some(after_s) = self.ended_after_s {
            let _ = writeln!(text, "Ended after {after_s:.3} s of {planned_s:.3} s");
        }
        if let Some(file) = &self.output {
            let _ = writeln!(text, "{} samples recorded in {file}", self.samples);
        }
        text
    }
}
