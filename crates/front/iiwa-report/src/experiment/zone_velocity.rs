//! Velocity in blends (Larsen 2019, Appendix B, Fig. 29).

use std::ops::Range;

use iiwa_eval::local_cubic;
use iiwa_kin::Joints;
use iiwa_log::JointLog;
use iiwa_path::PathOptions;
use iiwa_program::{Motion, Program};
use plotters::prelude::SeriesLabelPosition;

use crate::{
    ExperimentError,
    picture::{INK, shade},
};

use super::{
    bench::{Bench, TrialRun},
    chapter::Chapter,
    evaluation::path,
    plot::{Plot, PlotPoint, draw},
};

/// Half of the window for differentiating samples, in s.
const HALF_WINDOW_S: f64 = 0.02;

/// Effect of noise and of the window edges after differentiation, in % of the limits.
const NOISE_PERCENT: f64 = 0.5;

/// Colour steps from standstill to full speed.
const TONES: u32 = 20;

/// Indices of the moving joints.
const MOVING: [usize; 3] = [1, 3, 5];

pub(super) fn chapter(bench: &Bench, runs: &[TrialRun]) -> Result<Chapter, ExperimentError> {
    let mut chapter = Chapter::new("Velocity in blends: Appendix B, Fig. 29");
    let Some(TrialRun { trial, log }) = runs.first() else { return Ok(chapter) };
    chapter.paragraph(format!(
        "The program of Appendix B, unchanged, {}: four motions with blends of 200, 50 and 100 mm, \
         at 75, 10, 50 and 20 % of full speed. Samples are differentiated by cubics fitted to \
         {:.0} ms about each.",
        bench.on,
        2e3 * HALF_WINDOW_S
    ));
    let speeds = speeds(bench, log);
    let blends = blends(&path(bench, trial, PathOptions::default())?, log);
    let svg = figure(bench, log, &speeds, &blends, &trial.program)?;
    chapter.figure(
        bench,
        "29",
        "Fig. 29: path of the flange in the xz plane, coloured by the speed of joints 2, 4 and 6, \
         in % of their limits; circles where blends start and stop; the motions' relative \
         velocities beside them",
        svg,
    );

    let relative = |motion: usize| match trial.program.motions.get(motion) {
        Some(Motion::Ptp(ptp)) => 100.0 * ptp.velocity_rel[0],
        _ => f64::NAN,
    };
    let mut kept = 0;
    let rows: Vec<_> = blends
        .iter()
        .enumerate()
        .map(|(i, MeasuredBlend { samples, .. })| {
            let share = |i: &usize| 100.0 * speeds[*i].iter().fold(0.0, |a: f64, v| a.max(v.abs()));
            let peak = samples.clone().map(|i| share(&i)).fold(0.0, f64::max);
            kept += usize::from(peak <= relative(i + 1) + NOISE_PERCENT);
            vec![
                (i + 1).to_string(),
                format!("{:.0}", relative(i)),
                format!("{:.0}", relative(i + 1)),
                format!("{:.2}", share(&samples.start)),
                format!("{peak:.2}"),
            ]
        })
        .collect();
    chapter.table(
        &[
            "blend",
            "motion before %",
            "motion after %",
            "measured at its start %",
            "measured peak in it %",
        ],
        &rows,
    );
    chapter.paragraph(format!(
        "The velocity of the fastest joint, relative to its limit, stays within that of the next \
         motion, with a tolerance of {NOISE_PERCENT} % for the error of differentiation, in {kept} \
         of {} blends. The thesis reports that the arm slows down before the blend, keeps a \
         constant velocity in it, and that the velocity in the blend is bounded by the following \
         instruction's.",
        blends.len()
    ));
    Ok(chapter)
}

/// Blend, and its samples.
struct MeasuredBlend {
    ends_rad: [Joints; 2],
    samples: Range<usize>,
}

/// Locates the start and the end of each blend, and the samples in between.
fn blends(path: &iiwa_path::JointPath, log: &JointLog) -> Vec<MeasuredBlend> {
    let mut from = 0;
    let mut nearest = |to: &Joints| {
        let off = |q: &Joints| (0..7).map(|j| (q[j] - to[j]).powi(2)).sum::<f64>();
        let rest = log.q_rad.iter().enumerate().skip(from);
        let middle = rest.min_by(|a, b| off(a.1).total_cmp(&off(b.1))).map_or(from, |(i, _)| i);
        from = middle;
        middle
    };
    path.blends()
        .map(|(_, segment)| {
            let ends_rad = [segment.at(0.0).q, segment.at(1.0).q];
            let [start, end] = [nearest(&ends_rad[0]), nearest(&ends_rad[1])];
            MeasuredBlend { ends_rad, samples: start..end.max(start + 1) }
        })
        .collect()
}

/// Returns the speed of each joint at each sample, relative to its limit.
fn speeds(bench: &Bench, log: &JointLog) -> Vec<Joints> {
    let limits = &bench.model.limits().velocity_rad_s;
    let half_s = HALF_WINDOW_S.max(3.0 * log.period_s().unwrap_or_default());
    let mut speeds = vec![[0.0; 7]; log.t_s.len()];
    for j in 0..7 {
        let q: Vec<f64> = log.q_rad.iter().map(|q| q[j]).collect();
        for (speeds, t_s) in speeds.iter_mut().zip(&log.t_s) {
            let slope = local_cubic(&log.t_s, &q, *t_s, half_s).map_or(0.0, |fit| fit[1]);
            speeds[j] = slope / limits[j];
        }
    }
    speeds
}

fn figure(
    bench: &Bench,
    log: &JointLog,
    speeds: &[Joints],
    blends: &[MeasuredBlend],
    program: &Program,
) -> Result<String, ExperimentError> {
    let in_plane = |q: &Joints| {
        let [x, _, z] = bench.model.flange_position(q);
        (1e3 * x, 1e3 * z)
    };
    let trace: Vec<PlotPoint> = log.q_rad.iter().map(in_plane).collect();
    let circles: Vec<PlotPoint> =
        blends.iter().flat_map(|blend| blend.ends_rad.iter().map(in_plane)).collect();
    // Half-way between two blends, the velocity of that motion.
    let ends =
        blends.iter().map(|blend| blend.samples.start).chain([log.t_s.len().saturating_sub(1)]);
    let starts = [0].into_iter().chain(blends.iter().map(|blend| blend.samples.end));
    let notes: Vec<(PlotPoint, String)> = starts
        .zip(ends)
        .zip(&program.motions)
        .filter_map(|((start, end), motion)| match motion {
            Motion::Ptp(ptp) => {
                let (x, z) = *trace.get(usize::midpoint(start, end))?;
                Some(((x + 30.0, z + 45.0), ptp.velocity_rel[0].to_string()))
            }
            _ => None,
        })
        .collect();
    let plots: Vec<_> = MOVING
        .into_iter()
        .map(|joint| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "0 to TONES"
            )]
            let tone =
                |i: &usize| (speeds[*i][joint].abs().min(1.0) * f64::from(TONES)).round() as u32;
            let mut plot = Plot::new(format!("joint {}", joint + 1), "x mm", "z mm").equal_scale();
            let indices: Vec<usize> = (0..trace.len()).collect();
            for level in 0..=TONES {
                // Each part extends to the first point of the next.
                let parts = indices.chunk_by(|a, b| tone(a) == tone(b));
                let parts = parts.filter(|part| tone(&part[0]) == level).map(|part| {
                    let end = (part[part.len() - 1] + 1).min(trace.len() - 1);
                    trace[part[0]..=end].to_vec()
                });
                let label = if level % (TONES / 4) == 0 {
                    format!("{} %", 100 * level / TONES)
                } else {
                    String::new()
                };
                let colour = shade(f64::from(level) / f64::from(TONES));
                plot = plot.lines(parts.collect(), colour, 4.0, &label);
            }
            plot = plot.circles(circles.clone(), INK, "");
            for (position, text) in &notes {
                plot = plot.note(*position, text.clone());
            }
            plot.legend_at(SeriesLabelPosition::UpperRight)
        })
        .collect();
    draw(&plots, 3, 1440, 560)
}
