//! Cycle time errors (Larsen 2019, section 5.1.2, Eq. 40, Fig. 23 to 25).

use iiwa_eval::{
    PlannedTrajectory, compare,
    experiment::{CycleTimeCase, Sweep, Trial},
};
use iiwa_traj::{SweepOptions, Timing};
use plotters::prelude::{RGBColor, SeriesLabelPosition};

use crate::{ExperimentError, picture::COLOURS};

use super::{
    bench::{Bench, TrialRun},
    chapter::Chapter,
    evaluation::planned,
    plot::{Plot, PlotPoint, draw},
};

/// Colours of the time parameterisations: acceleration, jerk.
const TIMINGS: [RGBColor; 2] = [COLOURS[3], COLOURS[0]];

/// Varied parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Over {
    /// Parameter of the thesis.
    Thesis(Sweep),
    /// Path length, at full speed instead of the thesis's 0.4.
    LengthAtFullSpeed,
}

impl Over {
    const ALL: [Self; 4] = [
        Self::Thesis(Sweep::Velocity),
        Self::Thesis(Sweep::Blend),
        Self::Thesis(Sweep::Length),
        Self::LengthAtFullSpeed,
    ];

    fn cases(self) -> Vec<CycleTimeCase> {
        match self {
            Self::Thesis(sweep) => sweep.cases(),
            Self::LengthAtFullSpeed => {
                let at_full_speed = |case| CycleTimeCase { velocity_rel: 1.0, ..case };
                Sweep::Length.cases().into_iter().map(at_full_speed).collect()
            }
        }
    }

    fn value(self, case: &CycleTimeCase) -> f64 {
        match self {
            Self::Thesis(Sweep::Velocity) => case.velocity_rel,
            Self::Thesis(Sweep::Blend) => case.blend,
            Self::Thesis(Sweep::Length) | Self::LengthAtFullSpeed => case.length_deg,
        }
    }
}

/// Returns all cases: for each of the first paths, one case per value.
fn cases(paths: usize) -> Vec<(Over, CycleTimeCase)> {
    let cases_over = |over: Over| {
        let cases = over.cases().into_iter();
        cases.filter(move |case| case.path < paths as u64).map(move |case| (over, case))
    };
    Over::ALL.into_iter().flat_map(cases_over).collect()
}

/// Returns the programs; a program in several sweeps runs once.
pub(super) fn trials(bench: &Bench, paths: usize) -> Vec<Trial> {
    let mut trials: Vec<Trial> = Vec::new();
    for (_, case) in cases(paths) {
        let trial = case.trial(&bench.model, bench.seed);
        if trials.iter().all(|other| other.name != trial.name) {
            trials.push(trial);
        }
    }
    trials
}

/// Calculated and measured times of one case.
struct Case {
    over: Over,
    value: f64,
    path: u64,
    /// Measured cycle time `T_r`, in s.
    real_s: f64,
    /// `T_s - T_r` for both time parameterisations, in s.
    error_s: [f64; 2],
}

impl Case {
    fn percent(&self, timing: usize) -> f64 {
        100.0 * self.error_s[timing] / self.real_s
    }
}

pub(super) fn chapter(bench: &Bench, runs: &[TrialRun]) -> Result<Chapter, ExperimentError> {
    let cases = evaluate(bench, runs)?;
    let paths = cases.iter().map(|case| case.path + 1).max().unwrap_or_default();
    let mut chapter = Chapter::new("Errors of the cycle time: section 5.1.2, Fig. 23 to 25");
    chapter.paragraph(format!(
        "{paths} random paths of ten PTP motions, run {} over relative velocity, relative blend \
         and path length lambda. The thesis does not define its lambda; here it is the length of \
         each motion, the norm of the joint displacements, in degrees. The other parameters are \
         those of the thesis: velocity 0.4, blend 0.25, lambda 200.",
        bench.on
    ));
    chapter.paragraph(
        "T_r is measured, from the arm's departure to its arrival, plus the model's time to settle \
         at the end. T_s is calculated in two ways for the same path: with velocity and \
         acceleration limits, which is the thesis's method (\"acceleration\"), and with jerk \
         limits too, which is this project's method (\"jerk\"). The error is T_s - T_r, in s and \
         as a share of T_r (Eq. 40).",
    );
    for (over, number, title, axis, thesis) in [
        (
            Over::Thesis(Sweep::Velocity),
            "23",
            "Fig. 23: relative velocity",
            "relative velocity",
            "The thesis: around 0 % at low velocities, as much as 15 % at high ones.",
        ),
        (
            Over::Thesis(Sweep::Blend),
            "24",
            "Fig. 24: relative blend",
            "relative blend",
            "The thesis: calculated times are too short without blends, since the robot's jerk \
             limits are left out, and close to the robot's as blends grow.",
        ),
        (
            Over::Thesis(Sweep::Length),
            "25",
            "Fig. 25: path length",
            "path length lambda, deg",
            "The thesis: constant within 2 % for longer paths, a marginally bigger difference for \
             shorter ones.",
        ),
        (
            Over::LengthAtFullSpeed,
            "25-full-speed",
            "Path length at full speed",
            "path length lambda, deg",
            "Not in the thesis, whose largest error at high velocities is 15 % with lambda = 200, \
             in a unit that it does not state.",
        ),
    ] {
        let its: Vec<_> = cases.iter().filter(|case| case.over == over).collect();
        chapter.heading(title);
        let caption = format!(
            "{title}; error of the cycle time of {paths} random paths (thin) and their mean (thick)"
        );
        chapter.figure(bench, number, &caption, figure(over, axis, &its)?);
        table(&mut chapter, axis, &its);
        chapter.paragraph(thesis);
        chapter.paragraph(finding(&its));
        if over == Over::LengthAtFullSpeed {
            chapter.paragraph(like_the_thesis(&its));
        }
    }
    let largest =
        |timing: usize| cases.iter().map(|case| case.percent(timing).abs()).fold(0.0, f64::max);
    chapter.heading("Summary");
    chapter.paragraph(format!(
        "Over all programs, the largest error is {:.2} % by acceleration and {:.2} % by jerk.",
        largest(0),
        largest(1)
    ));
    Ok(chapter)
}

fn evaluate(bench: &Bench, runs: &[TrialRun]) -> Result<Vec<Case>, ExperimentError> {
    let measured = runs.iter().map(|TrialRun { trial, log }| {
        let jerk = planned(&bench.model, trial, Timing::jerk_limited())?;
        let acceleration =
            planned(&bench.model, trial, Timing::Acceleration(SweepOptions::default()))?
                .cycle_time_s();
        let compared = compare(&PlannedTrajectory::from_trajectory(&jerk), log)
            .map_err(|source| ExperimentError::Compare { name: trial.name.clone(), source })?;
        let real_s = compared.cycle_time.real_s;
        Ok((real_s, [acceleration - real_s, jerk.cycle_time_s() - real_s]))
    });
    let measured: Vec<_> = measured.collect::<Result<_, ExperimentError>>()?;
    // Path numbers start with the first path.
    let all = cases(5).into_iter().filter_map(|(over, case)| {
        let name = case.trial(&bench.model, bench.seed).name;
        let (real_s, error_s) = measured[runs.iter().position(|run| run.trial.name == name)?];
        let value = over.value(&case);
        Some(Case { over, value, path: case.path, real_s, error_s })
    });
    Ok(all.collect())
}

/// Groups the cases by their values, in ascending order.
fn by_value<'a>(cases: &[&'a Case]) -> Vec<(f64, Vec<&'a Case>)> {
    let mut values: Vec<f64> = cases.iter().map(|case| case.value).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let cases_with =
        |value: f64| cases.iter().filter(|case| case.value == value).copied().collect();
    values.into_iter().map(|value| (value, cases_with(value))).collect()
}

fn mean(cases: &[&Case], quantity: impl Fn(&Case) -> f64) -> f64 {
    cases.iter().map(|case| quantity(case)).sum::<f64>() / cases.len() as f64
}

fn figure(over: Over, axis: &str, cases: &[&Case]) -> Result<String, ExperimentError> {
    let grouped = by_value(cases);
    // Corner without lines.
    let legend_at = match over {
        Over::Thesis(Sweep::Velocity) => SeriesLabelPosition::LowerLeft,
        _ => SeriesLabelPosition::LowerRight,
    };
    let panel = |title: &str, unit: &str, quantity: &dyn Fn(&Case, usize) -> f64| {
        let mut plot = Plot::new(title, axis, unit).legend_at(legend_at.clone());
        for (timing, (colour, name)) in
            TIMINGS.into_iter().zip(["acceleration", "jerk"]).enumerate()
        {
            let paths = (0..5).map(|path| {
                let its = cases.iter().filter(|case| case.path == path);
                its.map(|case| (case.value, quantity(case, timing))).collect::<Vec<PlotPoint>>()
            });
            let means: Vec<PlotPoint> = grouped
                .iter()
                .map(|(value, cases)| (*value, mean(cases, |case| quantity(case, timing))))
                .collect();
            plot = plot
                .lines(paths.collect(), colour, 1.0, "")
                .line(means.clone(), colour, 3.0, &format!("timing by {name}"))
                .dots(means, colour, "");
        }
        plot
    };
    let plots = [
        panel("error in per cent of the measured time", "error %", &|case, timing| {
            case.percent(timing)
        }),
        panel("error in seconds", "error s", &|case, timing| case.error_s[timing]),
    ];
    draw(&plots, 2, 1200, 440)
}

fn table(chapter: &mut Chapter, axis: &str, cases: &[&Case]) {
    let extremes = |cases: &[&Case], timing: usize| {
        let all = || cases.iter().map(|case| case.percent(timing));
        let (low, high) = (all().fold(f64::MAX, f64::min), all().fold(f64::MIN, f64::max));
        format!("{low:+.2} to {high:+.2}")
    };
    let rows: Vec<_> = by_value(cases)
        .into_iter()
        .map(|(value, cases)| {
            vec![
                value.to_string(),
                format!("{:.3}", mean(&cases, |case| case.real_s)),
                format!("{:+.3}", mean(&cases, |case| case.error_s[0])),
                format!("{:+.2}", mean(&cases, |case| case.percent(0))),
                extremes(&cases, 0),
                format!("{:+.3}", mean(&cases, |case| case.error_s[1])),
                format!("{:+.3}", mean(&cases, |case| case.percent(1))),
                extremes(&cases, 1),
            ]
        })
        .collect();
    chapter.table(
        &[
            axis,
            "measured s",
            "acceleration: error s",
            "%",
            "% from, to",
            "jerk: error s",
            "%",
            "% from, to",
        ],
        &rows,
    );
}

/// Summarises the figures in a sentence.
fn finding(cases: &[&Case]) -> String {
    let grouped = by_value(cases);
    let (Some((low, first)), Some((high, last))) = (grouped.first(), grouped.last()) else {
        return String::new();
    };
    let worst = cases.iter().map(|case| case.percent(1).abs()).fold(0.0, f64::max);
    format!(
        "Here: on average {:+.2} % at {low} and {:+.2} % at {high} by acceleration; by jerk no \
         error is larger than {worst:.2} %.",
        mean(first, |case| case.percent(0)),
        mean(last, |case| case.percent(0)),
    )
}

/// Reports the path length at which the errors are as large as in the thesis.
fn like_the_thesis(cases: &[&Case]) -> String {
    const THESIS_PERCENT: f64 = 15.0;
    let off = |cases: &[&Case]| (mean(cases, |case| case.percent(0)).abs() - THESIS_PERCENT).abs();
    let grouped = by_value(cases);
    match grouped.iter().min_by(|a, b| off(&a.1).total_cmp(&off(&b.1))) {
        Some((length, cases)) if off(cases) < 5.0 => format!(
            "The thesis's {THESIS_PERCENT} % are closest to the error of motions of {length} deg \
             here. If its lambda = 200 were in degrees, the missing jerk limits alone would not \
             explain them on this robot."
        ),
        _ => String::new(),
    }
}
