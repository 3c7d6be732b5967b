//! Blends of TCP paths. The thesis names TCP motions as future work, and has no figure of them.

use iiwa_eval::identify::{CourseObservation, CoursePart, Identified, TcpBlendObservation};
use iiwa_kin::Joints;
use iiwa_path::{JointPath, PathOptions};
use plotters::prelude::SeriesLabelPosition;

use crate::{
    ExperimentError,
    picture::{MEASURED, PLANNED},
};

use super::{
    bench::{Bench, TrialRun},
    chapter::Chapter,
    evaluation::{identified, left_out, path},
    kappa_plots::kappa_plots,
    plot::{Plot, PlotPoint, draw},
};

pub(super) fn chapter(bench: &Bench, runs: &[TrialRun]) -> Result<Chapter, ExperimentError> {
    let mut chapter = Chapter::new("Blends of TCP paths: not in the thesis");
    let Some(run) = runs.first() else { return Ok(chapter) };
    let identified = identified(bench, runs)?;
    chapter.paragraph(format!(
        "The thesis measured blends between motions that are straight in joint space, and names \
         TCP motions as future work. The blend shape of the robot's controller, and the course of \
         orientation and E1 along the path, are assumed; docs/cartesian.md lists the assumptions. \
         This program shows them, {}: with the flange downwards, the TCP turns corners at one \
         point in a horizontal plane, at angles from 0 to 170 deg, with blends of 40 mm between \
         LINs of 120 and 90 mm; with blends that are longer than half of the shorter LIN; with \
         orientation and E1 that change; between LIN and CIRC; and between PTP and LIN.",
        bench.on
    ));
    let plots = corners(bench, run, &identified)?;
    if !plots.is_empty() {
        chapter.figure(
            bench,
            "tcp-paths",
            "Blends between LINs, calculated (blue) and as measured (red)",
            draw(&plots, 2, 1200, 620)?,
        );
    }
    kappa(bench, &mut chapter, &identified)?;
    reach(&mut chapter, &identified);
    laws(&mut chapter, &identified.courses);
    chapter.paragraph(left_out(runs, &identified.left_out));
    Ok(chapter)
}

/// Plots the paths near the corners: blends of full length, and blends shortened to half of a
/// motion.
fn corners(
    bench: &Bench,
    run: &TrialRun,
    identified: &Identified,
) -> Result<Vec<Plot>, ExperimentError> {
    let path = path(bench, &run.trial, PathOptions::default())?;
    let mut lengths_m: Vec<f64> = identified.tcp_blends.iter().map(|blend| blend.reach_m).collect();
    lengths_m.sort_by(|a, b| b.total_cmp(a));
    lengths_m.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    let plot = |reach_m: &f64| {
        let blends =
            identified.tcp_blends.iter().filter(|blend| (blend.reach_m - reach_m).abs() < 1e-6);
        let (measured, calculated) = blends
            .map(|blend| (measured(bench, run, &path, blend), calculated(&path, blend)))
            .unzip();
        Plot::new(format!("both sides {:.0} mm", 1e3 * reach_m), "y, mm", "x, mm")
            .lines(measured, MEASURED, 3.0, "measured")
            .lines(calculated, PLANNED, 1.0, "calculated")
            .equal_scale()
            .legend_at(SeriesLabelPosition::UpperLeft)
    };
    Ok(lengths_m.iter().map(plot).collect())
}

/// Returns the TCP seen from above, in mm: y to the right, x upwards.
fn from_above(path: &JointPath, blend: &TcpBlendObservation, joints: &Joints) -> PlotPoint {
    let tcp = path.robot().flange_pose(joints).then(path.tcp(blend.motion));
    (1e3 * tcp.position_m[1], 1e3 * tcp.position_m[0])
}

fn measured(
    bench: &Bench,
    run: &TrialRun,
    path: &JointPath,
    blend: &TcpBlendObservation,
) -> Vec<PlotPoint> {
    debug_assert_eq!(path.robot().lengths(), bench.model.lengths());
    let sample_at = |t_s: f64| run.log.t_s.partition_point(|t| *t < t_s);
    let [from, to] = blend.time_s.map(sample_at);
    run.log.q_rad[from..to].iter().map(|q| from_above(path, blend, q)).collect()
}

fn calculated(path: &JointPath, blend: &TcpBlendObservation) -> Vec<PlotPoint> {
    let of_motion = path.blends().find(|(corner, _)| corner.motion == blend.motion);
    let Some((_, segment)) = of_motion else { return Vec::new() };
    (0..=100).map(|i| from_above(path, blend, &segment.at(f64::from(i) / 100.0).q)).collect()
}

fn kappa(
    bench: &Bench,
    chapter: &mut Chapter,
    identified: &Identified,
) -> Result<(), ExperimentError> {
    let Some(kappa) = &identified.tcp_kappa else {
        chapter.paragraph("Too few blends were found for kappa(gamma).");
        return Ok(());
    };
    let observed =
        identified.tcp_blends.iter().map(|blend| (blend.gamma_deg, blend.kappa.0)).collect();
    let words = ["the model", "kappa minus the model's"];
    let plots = kappa_plots(kappa, observed, |gamma| bench.model.tcp_kappa(gamma), words);
    let caption = "kappa as found in each blend between two LINs, over the angle of the TCP's \
        directions; the polynomial through all of them, and the model's";
    chapter.figure(bench, "tcp-kappa", caption, draw(&plots, 2, 1200, 440)?);
    let [c0, c1, c2] = kappa.coefficients();
    let [m0, m1, m2] = bench.model.tcp_blend_kappa();
    chapter.paragraph(format!(
        "Found in {} blends from {:.0} to {:.0} deg: kappa = {c2:.8} gamma^2 {c1:+.8} gamma \
         {c0:+.8}, with {:.4} as the root mean square of the residuals. The model has {m2:.8} \
         gamma^2 {m1:+.8} gamma {m0:+.8}, which leave over {:.4}. In a profile it is \
         `tcp_blend_kappa`.",
        identified.tcp_blends.len(),
        kappa.gamma_deg[0],
        kappa.gamma_deg[1],
        kappa.residual,
        kappa.residual_of_model
    ));
    Ok(())
}

/// Reports the start and the end of blends.
fn reach(chapter: &mut Chapter, identified: &Identified) {
    let mut rows = Vec::new();
    if let Some(reach) = &identified.tcp_reach {
        for (side, reach) in ["before the target", "behind the target"].into_iter().zip(reach) {
            let label = format!("way {side}, as a share of `cart_mm`");
            rows.push(vec![label, reach.to_string(), reach.count.to_string(), "1".to_owned()]);
        }
    }
    if let Some(share) = &identified.tcp_unequal_share {
        let label = "difference of both sides, as a share of that without evening them".to_owned();
        rows.push(vec![label, share.to_string(), share.count.to_string(), "0".to_owned()]);
    }
    if !rows.is_empty() {
        chapter.table(&["where blends begin and end", "found (95 %)", "blends", "assumed"], &rows);
    }
}

/// Largest change of an orientation or of E1, in rad, that counts as constant.
const CONSTANT_RAD: f64 = 1e-6;

/// Reports the deviations from the assumed laws of orientation, E1 and blends with joint motions.
fn laws(chapter: &mut Chapter, courses: &[CourseObservation]) {
    let changes = |course: &CourseObservation| {
        [course.turn_rad, course.e1_rad].map(|change| change > CONSTANT_RAD)
    };
    let kinds: [(&str, [bool; 2]); 4] = [
        ("", [false, false]),
        (", orientation changes", [true, false]),
        (", E1 changes", [false, true]),
        (", both change", [true, true]),
    ];
    let mut rows = Vec::new();
    for part in CoursePart::ALL {
        for (words, kind) in kinds {
            let of_kind = || {
                let joints = part == CoursePart::JointBlend;
                let all = courses.iter().filter(move |course| course.part == part);
                // In joint space both always change.
                all.filter(
                    move |course| if joints { words.is_empty() } else { changes(course) == kind },
                )
            };
            if of_kind().next().is_none() {
                continue;
            }
            let largest = |figure: &dyn Fn(&CourseObservation) -> f64| {
                format!("{:.4}", of_kind().map(figure).fold(0.0, f64::max))
            };
            rows.push(vec![
                format!("{part}{words}"),
                of_kind().count().to_string(),
                largest(&|course| 1e3 * course.off_m),
                largest(&|course| course.turn_off_rad.to_degrees()),
                largest(&|course| course.e1_off_rad.to_degrees()),
            ]);
        }
    }
    if rows.is_empty() {
        return;
    }
    chapter.table(&["part", "number", "TCP mm", "orientation deg", "E1 deg"], &rows);
    chapter.paragraph(
        "Largest deviations from the assumed paths, with the identified kappa: each sample is \
         compared with the point of the assumed path that is nearest to its TCP, regardless of \
         time. They include noise.",
    );
}
