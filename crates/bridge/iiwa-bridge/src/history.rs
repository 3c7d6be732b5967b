//! Cycle times of programs over their runs.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::message::{Content, Message, RunMessage, RunPhase, Timestamp};

/// Runs of programs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct History {
    /// Programs by robot and name; runs without a program name are grouped together.
    pub programs: Vec<ProgramHistory>,
}

/// Runs of a program on a robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProgramHistory {
    /// The robot.
    pub robot: String,
    /// The program, if clients state its name.
    pub program: Option<String>,
    /// Runs in order.
    pub runs: Vec<PastRun>,
    /// Median of the measured cycle times, in s, if any.
    pub median_s: Option<f64>,
    /// Increase of the cycle time of the latest runs over the previous ones.
    pub drift: Option<Drift>,
}

/// A completed run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PastRun {
    /// End time.
    pub at: Timestamp,
    /// Number of the run.
    pub run: u64,
    /// The planned cycle time, in s, if the client stated it.
    pub planned_s: Option<f64>,
    /// Measured cycle time, in s, if known.
    pub measured_s: Option<f64>,
    /// The reason for a failure.
    pub error: Option<String>,
}

/// Increase of the cycle time of the latest runs over the previous ones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Drift {
    /// Increase in per cent; negative if the latest runs are faster.
    pub percent: f64,
    /// Number of latest runs.
    pub recent: usize,
    /// Number of previous runs.
    pub before: usize,
    /// Compared quantity: `measured_over_planned` if all runs have a plan, so that edits of the
    /// program do not count; `measured` otherwise.
    pub of: &'static str,
}

impl History {
    /// Creates the history from messages in order; `recent` is the number of latest runs that are
    /// compared with the previous ones.
    #[must_use]
    pub fn of(messages: impl IntoIterator<Item = Message>, recent: usize) -> Self {
        let mut programs: BTreeMap<(String, Option<String>), Vec<PastRun>> = BTreeMap::new();
        for message in messages {
            let Message { robot, at, content: Content::Run(run), .. } = message else { continue };
            let RunMessage { event: RunPhase::End, run, label, result, .. } = run else { continue };
            let result = result.unwrap_or_default();
            programs.entry((robot, label.program)).or_default().push(PastRun {
                at,
                run,
                planned_s: label.plan.map(|plan| plan.cycle_time_s),
                measured_s: result.cycle_time_s,
                error: result.error.map(|error| error.message),
            });
        }
        let of = |((robot, program), runs): ((String, Option<String>), Vec<PastRun>)| {
            let measured = succeeded(&runs).filter_map(|run| run.measured_s);
            let median_s = median(measured.collect());
            let drift = Drift::of(&runs, recent);
            ProgramHistory { robot, program, runs, median_s, drift }
        };
        Self { programs: programs.into_iter().map(of).collect() }
    }
}

impl ProgramHistory {
    /// Returns the number of runs that did not succeed.
    #[must_use]
    pub fn failed(&self) -> usize {
        self.runs.iter().filter(|run| run.error.is_some()).count()
    }
}

impl ProgramHistory {
    /// Returns the latest measured times as a line of bars, from the shortest to the longest.
    #[must_use]
    pub fn trend(&self) -> String {
        const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
        const SHOWN: usize = 12;
        let times: Vec<f64> = self.runs.iter().filter_map(|run| run.measured_s).collect();
        let times = &times[times.len().saturating_sub(SHOWN)..];
        let low = times.iter().copied().fold(f64::INFINITY, f64::min);
        let high = times.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // A variation of a few ms is noise.
        let range = (high - low).max(0.01 * high);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 7")]
        let bar = |time: &f64| BARS[(((time - low) / range * 7.0).round() as usize).min(7)];
        times.iter().map(bar).collect()
    }
}

impl Drift {
    fn of(runs: &[PastRun], recent: usize) -> Option<Self> {
        let timed = || succeeded(runs).filter_map(|run| Some((run.measured_s?, run.planned_s)));
        let has_plans = timed().all(|(_, planned)| planned.is_some_and(|planned| planned > 0.0));
        let values: Vec<f64> = timed()
            .map(|(measured, planned)| match planned {
                Some(planned) if has_plans => measured / planned,
                _ => measured,
            })
            .collect();
        let (before, latest) = values.split_at(values.len().checked_sub(recent.max(1))?);
        let (old, new) = (median(before.to_vec())?, median(latest.to_vec())?);
        (old > 0.0).then(|| Self {
            percent: 100.0 * (new / old - 1.0),
            recent: latest.len(),
            before: before.len(),
            of: if has_plans { "measured_over_planned" } else { "measured" },
        })
    }
}

fn succeeded(runs: &[PastRun]) -> impl Iterator<Item = &PastRun> {
    runs.iter().filter(|run| run.error.is_none())
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        odd if odd % 2 == 1 => Some(values[middle]),
        _ => Some(f64::midpoint(values[middle - 1], values[middle])),
    }
}

#[cfg(test)]
mod tests {
    use iiwa_link::message::{RunEnd, RunLabel, RunPlan};

    use super::*;
    use crate::message::{RunKind, VERSION};

    fn run(seq: u64, program: Option<&str>, planned: Option<f64>, measured: f64) -> Message {
        let plan = planned.map(|cycle_time_s| RunPlan { cycle_time_s, limited_by: Vec::new() });
        let mut result = RunEnd::default();
        result.cycle_time_s = Some(measured);
        Message {
            version: VERSION,
            robot: "cell".to_owned(),
            session: 1,
            seq,
            at: Timestamp::from_micros(seq),
            content: Content::Run(RunMessage {
                t_s: 0.0,
                run: seq,
                event: RunPhase::End,
                what: RunKind::Motions,
                label: RunLabel { program: program.map(str::to_owned), plan, planned_for: None },
                result: Some(result),
            }),
        }
    }

    #[test]
    fn drift_is_that_of_the_latest_runs() {
        let slower = (0..10).map(|i| run(i, Some("a"), None, if i < 8 { 2.0 } else { 2.1 }));
        let history = History::of(slower, 2);
        let drift = history.programs[0].drift.unwrap();
        assert!((drift.percent - 5.0).abs() < 1e-9);
        assert_eq!((drift.recent, drift.before, drift.of), (2, 8, "measured"));
        assert_eq!(history.programs[0].median_s, Some(2.0));
        assert_eq!(history.programs[0].trend(), "▁▁▁▁▁▁▁▁██");
    }

    #[test]
    fn an_edited_program_does_not_drift() {
        let edited = (0..6).map(|i| {
            let planned = if i < 3 { 2.0 } else { 4.0 };
            run(i, Some("a"), Some(planned), planned * 1.01)
        });
        let drift = History::of(edited, 3).programs[0].drift.unwrap();
        assert!(drift.percent.abs() < 1e-9);
        assert_eq!(drift.of, "measured_over_planned");
    }

    #[test]
    fn programs_are_separated_and_failures_do_not_count() {
        let mut failed = run(3, Some("a"), None, 9.0);
        if let Content::Run(RunMessage { result: Some(result), .. }) = &mut failed.content {
            result.error = Some(iiwa_link::message::Refusal::robot("stopped"));
        }
        let history =
            History::of([run(0, None, None, 1.0), run(1, Some("a"), None, 2.0), failed], 5);
        let [unnamed, named] = &history.programs[..] else { panic!("{history:?}") };
        assert_eq!((unnamed.program.as_deref(), named.program.as_deref()), (None, Some("a")));
        assert_eq!((named.runs.len(), named.failed(), named.median_s), (2, 1, Some(2.0)));
        // No runs precede the latest five.
        assert_eq!(named.drift, None);
    }

    #[test]
    fn medians_of_any_number() {
        assert_eq!(median(vec![]), None);
        assert_eq!(median(vec![3.0, 1.0]), Some(2.0));
        assert_eq!(median(vec![3.0, 1.0, 7.0]), Some(3.0));
    }
}
