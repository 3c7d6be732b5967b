//! Blend curve (Larsen 2019, sections 4.2 and 4.3: Fig. 15 to 18, 20 and 21).

use iiwa_eval::identify::{BlendObservation, Identified};
use iiwa_kin::Joints;
use iiwa_path::{BlendShape, Continuity, JointPath, PathOptions, PolynomialBlend, Segment, Step};
use plotters::prelude::SeriesLabelPosition;

use crate::{
    ExperimentError,
    picture::{INK, MEASURED, PLANNED},
};

use super::{
    bench::{Bench, TrialRun},
    chapter::Chapter,
    evaluation::{identified, left_out, path},
    kappa_plots::kappa_plots,
    plot::{Plot, PlotPoint, draw},
};

/// Motions per corner: to the corner, on to a target on the circle, and back to the start.
const MOTIONS: usize = 3;

/// Half the side of an enlarged view, relative to the blend distance.
const ENLARGED: f64 = 1.3;

/// Index of the corner in Fig. 18: 90 deg.
const SHOWN: usize = 9;

/// Values of kappa in Fig. 18.
const KAPPAS: [f64; 5] = [-8.0, -4.0, 0.0, 4.0, 7.5];

pub(super) fn chapter(bench: &Bench, runs: &[TrialRun]) -> Result<Chapter, ExperimentError> {
    let mut chapter =
        Chapter::new("The curve of blends: sections 4.2 and 4.3, Fig. 15 to 18, 20, 21");
    let Some(run) = runs.first() else { return Ok(chapter) };
    let identified = identified(bench, runs)?;
    let corners = corners(bench, run, &identified)?;
    chapter.paragraph(format!(
        "Only joints 2 and 4 move, {}: to a corner with a relative blend of 0.25, and on to 36 \
         targets in a circle about it. The corner is 40 deg from the start and 25 deg from the \
         targets; the thesis does not state its distances.",
        bench.on
    ));
    let shapes = [
        ("15", "Eq. 13", BlendShape::Alpha(Continuity::Second), "a clear deviation"),
        ("16", "Eq. 26", BlendShape::MinAcceleration, "fails as well"),
        ("17", "Eq. 32", BlendShape::Circle, "fails; the path is not a circle"),
        ("21", "Eq. 39", BlendShape::Iiwa, "accurate, some differences"),
    ];
    let mut rows = Vec::new();
    let mut figures = Vec::new();
    for (number, equation, blend_shape, thesis) in shapes {
        let options = PathOptions { blend_shape, ..PathOptions::default() };
        let path = path(bench, &run.trial, options)?;
        let calculated: Vec<_> = corners.iter().map(|corner| corner.calculated(&path)).collect();
        let off: Vec<_> = corners
            .iter()
            .zip(&calculated)
            .filter_map(|(corner, calculated)| corner.deviation(calculated))
            .collect();
        let mean = off.iter().map(|(mean, _)| mean).sum::<f64>() / off.len() as f64;
        let max = off.iter().map(|(_, max)| *max).fold(0.0, f64::max);
        rows.push(vec![
            format!("{equation} (Fig. {number})"),
            format!("{mean:.4}"),
            format!("{max:.4}"),
            thesis.to_owned(),
        ]);
        let caption = format!("Fig. {number}: blends by {equation} (blue) and as measured (red)");
        figures.push((number, caption, overview(&corners, &calculated)?));
    }
    chapter.paragraph(
        "The table lists deviations in the plane of the two joints, over the part of the path \
         where any of the shapes is curved: distances from each point of either path to the \
         nearest point of the other, as mean over the path and as maximum. The thesis has figures \
         only.",
    );
    chapter.table(&["shape", "mean deg", "largest deg", "the thesis, in words"], &rows);
    // Figures in the order of the thesis.
    let eq_39 = figures.pop();
    for (number, caption, svg) in figures {
        chapter.figure(bench, number, &caption, svg);
    }
    if let Some(corner) = corners.get(SHOWN) {
        let caption = "Fig. 18: one blend with different kappa (blue) and as measured (red)";
        chapter.figure(bench, "18", caption, effect(corner)?);
        chapter.paragraph(
            "As in the thesis, kappa moves the blend along the corner's bisector and does not move \
             its ends.",
        );
    }
    kappa(bench, &mut chapter, &identified)?;
    if let Some((number, caption, svg)) = eq_39 {
        chapter.figure(bench, number, &caption, svg);
    }
    if let Some(share) = identified.unequal_share {
        chapter.paragraph(format!(
            "The two motions at a corner differ in length. By Algorithm 3, a blend starts and ends \
             at equal distances from its corner all the same, those of the shorter motion. \
             Measured: {share} of the difference without this rule (0: equal distances; 1: no \
             effect of the rule)."
        ));
    }
    chapter.paragraph(left_out(runs, &identified.left_out));
    Ok(chapter)
}

/// Adds kappa over gamma: Fig. 20.
fn kappa(
    bench: &Bench,
    chapter: &mut Chapter,
    identified: &Identified,
) -> Result<(), ExperimentError> {
    let Some(kappa) = &identified.kappa else {
        chapter.paragraph("Too few blends were found for kappa(gamma).");
        return Ok(());
    };
    let observed: Vec<PlotPoint> = identified
        .blends
        .iter()
        .map(|BlendObservation { gamma_deg, kappa, .. }| (*gamma_deg, kappa.0))
        .collect();
    let words = ["the model: Eq. 38", "kappa minus Eq. 38"];
    let plots = kappa_plots(kappa, observed, |gamma| bench.model.kappa(gamma), words);
    chapter.figure(
        bench,
        "20",
        "Fig. 20: kappa as found in each blend, the polynomial through all of them, and the \
         model's",
        draw(&plots, 2, 1200, 440)?,
    );
    let [c0, c1, c2] = kappa.coefficients();
    let [m0, m1, m2] = bench.model.blend_kappa();
    chapter.paragraph(format!(
        "Found in {} blends from {:.0} to {:.0} deg: kappa = {c2:.8} gamma^2 {c1:+.8} gamma \
         {c0:+.8}, with {:.4} as the root mean square of the residuals. The model has {m2:.8} \
         gamma^2 {m1:+.8} gamma {m0:+.8}. Eq. 38 of the thesis, tuned by hand, is kappa = \
         0.00028472 gamma^2 + 0.00626016 gamma - 3.97426471.",
        identified.blends.len(),
        kappa.gamma_deg[0],
        kappa.gamma_deg[1],
        kappa.residual
    ));
    Ok(())
}

/// Corner with its measured positions.
struct MeasuredCorner {
    index: usize,
    target_deg: PlotPoint,
    before_rad: Joints,
    target_rad: Joints,
    after_rad: Joints,
    /// Distance from the target to the start and the end of the blend, in degrees.
    reach_deg: f64,
    measured: Vec<PlotPoint>,
}

/// Returns joints 2 and 4 in degrees.
fn in_plane(q: &Joints) -> PlotPoint {
    (q[1].to_degrees(), q[3].to_degrees())
}

/// Returns the corners, with the samples from the end of the return motion before them to the start
/// of the return motion after them.
fn corners(
    bench: &Bench,
    run: &TrialRun,
    identified: &Identified,
) -> Result<Vec<MeasuredCorner>, ExperimentError> {
    let path = path(bench, &run.trial, PathOptions::default())?;
    let log = &run.log;
    let mut from_s = log.t_s.first().copied().unwrap_or_default();
    let mut corners = Vec::new();
    for index in 0..run.trial.program.motions.len() / MOTIONS {
        let back = MOTIONS * index + 2;
        let Some(line) = identified.lines.iter().find(|line| line.motion.index() == back) else {
            continue;
        };
        let [to_s, next_s] = line.time_s;
        let first = log.t_s.partition_point(|t_s| *t_s < from_s);
        let last = log.t_s.partition_point(|t_s| *t_s <= to_s);
        from_s = next_s;
        let before_rad = *path.start_rad();
        let target = |motion: usize| match run.trial.program.motions.get(motion) {
            Some(iiwa_program::Motion::Ptp(ptp)) => Some(ptp.target_rad),
            _ => None,
        };
        let (Some(target_rad), Some(after_rad)) = (target(back - 2), target(back - 1)) else {
            continue;
        };
        let of_blend = path.blends().find(|(corner, _)| corner.motion.index() == back - 2);
        let (a, b) = (in_plane(&target_rad), of_blend.map(|(_, segment)| segment.at(0.0).q));
        let b = in_plane(&b.unwrap_or(target_rad));
        corners.push(MeasuredCorner {
            index,
            target_deg: a,
            before_rad,
            target_rad,
            after_rad,
            reach_deg: (a.0 - b.0).hypot(a.1 - b.1),
            measured: log.q_rad[first..last.max(first)].iter().map(in_plane).collect(),
        });
    }
    Ok(corners)
}

impl MeasuredCorner {
    /// Returns the calculated path from the start over the corner to the target.
    fn calculated(&self, path: &JointPath) -> Vec<PlotPoint> {
        let first = MOTIONS * self.index;
        let mut points = Vec::new();
        for step in path.steps() {
            let Step::Move { motion, segment, .. } = step else { continue };
            if !(first..first + 2).contains(&motion.index()) {
                continue;
            }
            let count = if segment.is_straight() { 60 } else { 200 };
            let point = |i: i32| in_plane(&segment.at(f64::from(i) / f64::from(count)).q);
            points.extend((0..=count).map(point));
        }
        points
    }

    fn about(&self, point: &PlotPoint) -> bool {
        (point.0 - self.target_deg.0).hypot(point.1 - self.target_deg.1) <= self.reach_deg
    }

    /// Returns mean and largest distance between the measured and a calculated path, in degrees,
    /// near the corner and in both directions.
    fn deviation(&self, calculated: &[PlotPoint]) -> Option<(f64, f64)> {
        let (forward, back) =
            (self.one_way(&self.measured, calculated)?, self.one_way(calculated, &self.measured)?);
        Some((0.5 * (forward.0 + back.0), forward.1.max(back.1)))
    }

    fn one_way(&self, from: &[PlotPoint], to: &[PlotPoint]) -> Option<(f64, f64)> {
        let near: Vec<&[PlotPoint]> =
            to.windows(2).filter(|pair| pair.iter().any(|p| self.about(p))).collect();
        let (mut sum, mut way, mut max) = (0.0, 0.0, 0.0_f64);
        for pair in from.windows(2).filter(|pair| self.about(&pair[0])) {
            let step = (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1);
            let off = near.iter().map(|line| distance(pair[0], line[0], line[1]));
            let off = off.fold(f64::INFINITY, f64::min);
            sum += step * off;
            way += step;
            max = max.max(off);
        }
        (way > 0.0 && max.is_finite()).then(|| (sum / way, max))
    }
}

/// Distance between a point and a line segment.
fn distance(p: PlotPoint, a: PlotPoint, b: PlotPoint) -> f64 {
    let along = (b.0 - a.0, b.1 - a.1);
    let square = along.0 * along.0 + along.1 * along.1;
    let to = (p.0 - a.0, p.1 - a.1);
    let dot = to.0 * along.0 + to.1 * along.1;
    let share = if square > 0.0 { (dot / square).clamp(0.0, 1.0) } else { 0.0 };
    (to.0 - share * along.0).hypot(to.1 - share * along.1)
}

/// Draws all corners, as a whole and enlarged.
fn overview(
    corners: &[MeasuredCorner],
    calculated: &[Vec<PlotPoint>],
) -> Result<String, ExperimentError> {
    let measured: Vec<_> = corners.iter().map(|corner| corner.measured.clone()).collect();
    let Some(corner) = corners.first() else { return Ok(String::new()) };
    let plot = |caption: &str, [red, blue]: [&str; 2]| {
        Plot::new(caption, "joint 2, deg", "joint 4, deg")
            .lines(measured.clone(), MEASURED, 3.0, red)
            .lines(calculated.to_vec(), PLANNED, 1.0, blue)
            .equal_scale()
            .legend_at(SeriesLabelPosition::UpperLeft)
    };
    let (x, y) = corner.target_deg;
    let side = ENLARGED * corner.reach_deg;
    let plots = [
        plot("(a) overview", ["measured", "calculated"]),
        plot("(b) enlarged", ["", ""]).within(x - side..x + side, y - side..y + side),
    ];
    draw(&plots, 2, 1200, 620)
}

/// Draws one blend with different kappa: Fig. 18.
fn effect(corner: &MeasuredCorner) -> Result<String, ExperimentError> {
    let way = |from: &Joints, to: &Joints| -> Joints { std::array::from_fn(|j| to[j] - from[j]) };
    let scaled = |way: Joints| {
        let length = way.iter().map(|v| v * v).sum::<f64>().sqrt();
        way.map(|v| v / length * corner.reach_deg.to_radians())
    };
    let d0 = scaled(way(&corner.before_rad, &corner.target_rad));
    let d1 = scaled(way(&corner.target_rad, &corner.after_rad));
    let (x, y) = corner.target_deg;
    let side = ENLARGED * corner.reach_deg;
    let mut plot = Plot::new(
        format!("effect of kappa, gamma = {} deg", 10 * corner.index),
        "joint 2, deg",
        "joint 4, deg",
    )
    .line(corner.measured.clone(), MEASURED, 3.0, "measured")
    .equal_scale()
    .legend_at(SeriesLabelPosition::UpperLeft)
    .within(x - side..x + 0.3 * side, y - 0.3 * side..y + side);
    let lines: Vec<_> = KAPPAS
        .iter()
        .map(|kappa| {
            let blend =
                PolynomialBlend::new(&corner.target_rad, d0, &d1, *kappa, Continuity::Second);
            (0..=200).map(|i| in_plane(&blend.at(f64::from(i) / 200.0).q)).collect::<Vec<_>>()
        })
        .collect();
    for (line, kappa) in lines.iter().zip(KAPPAS) {
        let middle = line[line.len() / 2];
        plot = plot.note((middle.0 + 0.01 * side, middle.1), kappa.to_string());
    }
    let plot = plot.lines(lines, PLANNED, 1.0, "by Eq. 26, with its k beside").circles(
        vec![in_plane(&corner.target_rad)],
        INK,
        "point that is blended away",
    );
    draw(&[plot], 1, 720, 620)
}
