//! Joint limits (Larsen 2019, Appendix A: Tables 4 and 5, Fig. 28).

use iiwa_eval::{
    Estimate,
    experiment::Trial,
    identify::{Identified, LineObservation},
    local_cubic,
};
use iiwa_kin::Joint;
use iiwa_program::{Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{Timing, Trajectory};

use crate::{
    ExperimentError,
    picture::{MEASURED, PLANNED},
};

use super::{
    bench::{Bench, TrialRun},
    chapter::Chapter,
    evaluation::{identified, left_out, planned, spread},
    plot::{Plot, PlotPoint, draw},
};

/// Means and standard deviations of Table 4, in deg/s^2, and Table 5, in deg/s^3.
const THESIS: [[[f64; 7]; 2]; 2] = [
    [
        [490.77, 490.80, 500.77, 650.71, 700.73, 900.66, 900.69],
        [0.29, 0.29, 0.00, 0.27, 0.00, 0.13, 0.00],
    ],
    [
        [10384.86, 7757.85, 9986.65, 9700.18, 19406.08, 32260.39, 33028.15],
        [697.75, 754.50, 464.77, 674.89, 128.92, 453.62, 357.80],
    ],
];

/// Half of the window for differentiating samples in Fig. 28, in s.
const HALF_WINDOW_S: f64 = 0.02;

const JOINTS: [&str; 7] = ["A1", "A2", "A3", "A4", "A5", "A6", "A7"];

pub(super) fn chapter(bench: &Bench, runs: &[TrialRun]) -> Result<Chapter, ExperimentError> {
    let identified = identified(bench, runs)?;
    let mut chapter = Chapter::new("Joint limits: Appendix A, Tables 4 and 5, Fig. 28");
    let poses = runs.len().saturating_sub(1);
    chapter.paragraph(format!(
        "From each of {poses} poses of Table 3, each joint moves alone to -20 deg, to +20 deg and \
         back, at full speed, {}. The thesis differentiates samples and takes the maxima. Here the \
         seven phases of constant jerk are fitted to the positions of the motion from -20 to +20 \
         deg, so that noise is not differentiated. The thesis concludes that the limits do not \
         depend on the pose.",
        bench.on
    ));
    chapter.heading("Table 4: acceleration, deg/s^2");
    table(&mut chapter, &identified, poses, |line| line.acceleration_rad_s2, &THESIS[0]);
    chapter.heading("Table 5: jerk, deg/s^3");
    table(&mut chapter, &identified, poses, |line| line.jerk_rad_s3, &THESIS[1]);

    chapter.heading("Limits from all motions");
    chapter.paragraph(
        "A last program swings each joint by 70 deg about zero: joints 6 and 7 do not reach full \
         speed within the 40 deg of the thesis. Each figure is followed by half its 95 % \
         confidence interval.",
    );
    let limits = bench.model.limits();
    let cell = |estimate: &Option<Estimate>, model: f64| match estimate {
        Some(estimate) => {
            format!("{} ({:.2})", estimate.scaled(1_f64.to_degrees()), model.to_degrees())
        }
        None => format!("not seen ({:.2})", model.to_degrees()),
    };
    let rows: Vec<_> = (0..7)
        .map(|j| {
            vec![
                JOINTS[j].to_owned(),
                cell(&identified.velocity_rad_s[j], limits.velocity_rad_s[j]),
                cell(&identified.acceleration_rad_s2[j], limits.acceleration_rad_s2[j]),
                cell(&identified.jerk_rad_s3[j], limits.jerk_rad_s3[j]),
            ]
        })
        .collect();
    let head = ["found (model)", "velocity deg/s", "acceleration deg/s^2", "jerk deg/s^3"];
    chapter.table(&head, &rows);
    chapter.paragraph(left_out(runs, &identified.left_out));

    if let (Some(run), Some(line)) = (runs.first(), swing(&identified, 0, 0)) {
        let svg = figure(bench, run, line)?;
        let deg = |value: Option<f64>| match value {
            Some(value) => format!("{:.2}", value.to_degrees()),
            None => "none".to_owned(),
        };
        let caption = format!(
            "Fig. 28: joint 1 from -20 to +20 deg about pose 1. Red: samples, derivatives by \
             cubics fitted to {:.0} ms about each instant. Blue: the model's plan",
            2e3 * HALF_WINDOW_S
        );
        chapter.heading("Fig. 28");
        chapter.figure(bench, "28", &caption, svg);
        chapter.paragraph(format!(
            "The fit of seven phases gives {} deg/s, {} deg/s^2 and {} deg/s^3. The window of \
             differentiation rounds the edges of the jerk; the fit does not.",
            deg(line.speed_rad_s),
            deg(line.acceleration_rad_s2),
            deg(line.jerk_rad_s3)
        ));
    }
    Ok(chapter)
}

/// Returns the motion of a joint from -20 to +20 deg: the second of its three motions.
fn swing(identified: &Identified, recording: usize, joint: usize) -> Option<&LineObservation> {
    let its = |line: &&LineObservation| {
        line.recording == recording
            && line.joint.map(Joint::index) == Some(joint)
            && line.motion.index() == 3 * joint + 1
    };
    identified.lines.iter().find(its)
}

fn table(
    chapter: &mut Chapter,
    identified: &Identified,
    poses: usize,
    quantity: fn(&LineObservation) -> Option<f64>,
    [means, deviations]: &[[f64; 7]; 2],
) {
    let value = |run: usize, joint: usize| {
        swing(identified, run, joint).and_then(quantity).map(f64::to_degrees)
    };
    let text = |value: f64| format!("{value:.2}");
    let row = |name: &str, cells: [String; 7]| {
        std::iter::once(name.to_owned()).chain(cells).collect::<Vec<_>>()
    };
    let mut rows: Vec<_> = (0..poses)
        .map(|run| {
            let cell = |joint| value(run, joint).map_or_else(|| "-".to_owned(), text);
            row(&(run + 1).to_string(), std::array::from_fn(cell))
        })
        .collect();
    let all: [(f64, f64); 7] = std::array::from_fn(|joint| {
        spread(&(0..poses).filter_map(|run| value(run, joint)).collect::<Vec<_>>())
    });
    rows.push(row("mean", all.map(|(mean, _)| text(mean))));
    rows.push(row("standard deviation", all.map(|(_, deviation)| text(deviation))));
    rows.push(row("the thesis: mean", means.map(text)));
    rows.push(row("the thesis: standard deviation", deviations.map(text)));
    let head: Vec<_> = std::iter::once("run").chain(JOINTS).collect();
    chapter.table(&head, &rows);
}

fn figure(
    bench: &Bench,
    run: &TrialRun,
    line: &LineObservation,
) -> Result<String, ExperimentError> {
    let Some(joint) = line.joint.map(Joint::index) else { return Ok(String::new()) };
    let [start_s, end_s] = line.time_s;
    // The plan of the model for this motion alone.
    let program = Program {
        robot: None,
        start: Start::Joints(line.from_rad),
        motions: vec![Motion::Ptp(Ptp::to(line.to_rad))],
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let trial = Trial { name: run.trial.name.clone(), program };
    let planned: Trajectory = planned(&bench.model, &trial, Timing::jerk_limited())?;
    let middle_deg = 0.5 * (line.from_rad[joint] + line.to_rad[joint]).to_degrees();
    let around_s = 0.04;
    let whole_s = end_s - start_s + 2.0 * around_s;
    let step_s = 0.001;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let steps = (whole_s / step_s) as usize;
    let times: Vec<f64> = (0..=steps).map(|i| i as f64 * step_s - around_s).collect();

    let t_s = &run.log.t_s;
    let q: Vec<f64> = run.log.q_rad.iter().map(|q| q[joint].to_degrees() - middle_deg).collect();
    let half_s = HALF_WINDOW_S.max(4.0 * run.log.period_s().unwrap_or_default());
    let mut measured: [Vec<PlotPoint>; 4] = Default::default();
    let mut calculated: [Vec<PlotPoint>; 4] = Default::default();
    for at_s in times {
        if let Some(derivatives) = local_cubic(t_s, &q, start_s + at_s, half_s) {
            for (points, value) in measured.iter_mut().zip(derivatives) {
                points.push((at_s, value));
            }
        }
        let state = planned.at(at_s);
        let moving = (0.0..planned.motion_time_s()).contains(&at_s);
        let next = planned.at(at_s + 0.5 * step_s);
        let before = planned.at((at_s - 0.5 * step_s).max(0.0));
        let jerk = (next.ddq[joint] - before.ddq[joint]) / (next.t_s - before.t_s).max(1e-9);
        let values = [
            state.q[joint].to_degrees() - middle_deg,
            state.dq[joint].to_degrees(),
            state.ddq[joint].to_degrees(),
            jerk.to_degrees(),
        ];
        for (order, (points, value)) in calculated.iter_mut().zip(values).enumerate() {
            points.push((at_s, if moving || order == 0 { value } else { 0.0 }));
        }
    }
    let axes = ["position deg", "velocity deg/s", "acceleration deg/s^2", "jerk deg/s^3"];
    let plots: Vec<_> = axes
        .into_iter()
        .zip(measured.into_iter().zip(calculated))
        .enumerate()
        .map(|(i, (axis, (measured, calculated)))| {
            let label = |label: &'static str| if i == 0 { label } else { "" };
            Plot::new(axis.split(' ').next().unwrap_or(axis), "time s", axis)
                .line(measured, MEASURED, 3.0, label("measured"))
                .line(calculated, PLANNED, 1.0, label("model"))
                .legend_at(plotters::prelude::SeriesLabelPosition::LowerRight)
        })
        .collect();
    draw(&plots, 2, 960, 640)
}
