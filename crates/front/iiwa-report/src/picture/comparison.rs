//! Picture of a recording and a plan: both flange paths, and the deviations.

use iiwa_eval::{Comparison, PlannedTrajectory, TracePoint};
use plotters::prelude::{ChartBuilder, Color, LineSeries, Rectangle};

use super::{
    Area, DrawResult, FINE, HEIGHT, MEASURED, PLANNED, SHADE, Space, WIDTH, font,
    key::{LegendSign, title_and_legend},
    mesh, svg,
};
use crate::PictureError;

/// Number of points of the planned path.
const POINTS: u32 = 8000;

/// Draws a recording and its plan as SVG: both flange paths, and the deviations along them.
///
/// # Errors
///
/// [`PictureError::Drawing`].
pub fn draw(plan: &PlannedTrajectory, comparison: &Comparison) -> Result<String, PictureError> {
    let mm = |m: [f64; 3]| m.map(|v| 1e3 * v);
    let planned: Vec<_> = (0..=POINTS)
        .map(|k| plan.at(plan.cycle_time_s() * f64::from(k) / f64::from(POINTS)))
        .map(|q| mm(plan.robot().flange_position(&q)))
        .collect();
    let measured: Vec<_> = comparison.trace.iter().map(|point| mm(point.flange_m)).collect();
    let space = Space::of(planned.iter().chain(&measured).copied());
    svg([WIDTH, HEIGHT], |root| {
        let (top, bottom) = root.split_vertically(FINE * HEIGHT * 11 / 20);
        let [best, second, _] = space.planes();
        // Seen edge-on, a planar path is only a line.
        let size = |plane: (usize, usize)| space.extent(plane.0).min(space.extent(plane.1));
        if size(second) > 0.02 * size(best) {
            let (left, right) = top.split_horizontally(FINE * WIDTH / 2);
            draw_paths(&left, &space, best, (&planned, &measured))?;
            draw_paths(&right, &space, second, (&planned, &measured))?;
        } else {
            draw_paths(&top, &space, best, (&planned, &measured))?;
        }
        let (flange, joints) = bottom.split_vertically(FINE * HEIGHT * 9 / 40);
        let flange_off = |point: &TracePoint| 1e3 * point.flange_deviation_m;
        draw_deviation(&flange, ("Flange off its path", "mm"), comparison, flange_off)?;
        let joints_off = |point: &TracePoint| 1e3 * point.joints_rad;
        draw_deviation(&joints, ("Joints off their path", "mrad"), comparison, joints_off)
    })
}

/// Draws both paths in a plane.
fn draw_paths(
    area: &Area<'_>,
    space: &Space,
    (across, up): (usize, usize),
    (planned, measured): (&[[f64; 3]], &[[f64; 3]]),
) -> DrawResult {
    // Where both paths coincide, blue is visible on both sides of red.
    let paths = [
        ("planned", planned, PLANNED.stroke_width(5 * FINE)),
        ("measured", measured, MEASURED.stroke_width(3 * FINE / 2)),
    ];
    let entries = paths.map(|(name, _, style)| (LegendSign::Line, style, name.to_owned()));
    let area = title_and_legend(area, "Path of the flange", &entries)?;
    let mut chart = space.chart(&area, (across, up))?;
    for (_, path, style) in paths {
        let points = path.iter().map(|mm| (mm[across], mm[up]));
        chart.draw_series(LineSeries::new(points, style))?;
    }
    Ok(())
}

/// Smallest deviation that is distinguished from zero, in mm or mrad.
const MIN_SHOWN: f64 = 0.001;

/// Draws a deviation over the time since the program start; every other motion is shaded.
fn draw_deviation(
    area: &Area<'_>,
    (quantity, unit): (&str, &str),
    comparison: &Comparison,
    value: impl Fn(&TracePoint) -> f64,
) -> DrawResult {
    let trace = &comparison.trace;
    let start_s = trace.first().map_or(0.0, |point| point.plan_s - point.measured_s);
    let last_s = trace.last().map_or(0.0, |point| start_s + point.measured_s);
    let end_s = comparison.cycle_time.simulated_s.max(last_s).max(1e-3);
    let peak = trace.iter().map(&value).fold(0.0, f64::max);
    let top = 1.15 * peak.max(MIN_SHOWN);
    let title = if peak < MIN_SHOWN {
        format!("{quantity}: below {MIN_SHOWN} {unit}, over the arm's time in s")
    } else {
        format!("{quantity} in {unit}, over the arm's time in s")
    };
    let mut chart = ChartBuilder::on(area)
        .caption(title, font())
        .margin(8 * FINE)
        // Half of the last number exceeds the axis.
        .margin_right(24 * FINE)
        .x_label_area_size(30 * FINE)
        .y_label_area_size(62 * FINE)
        .build_cartesian_2d(0.0..end_s, 0.0..top)?;
    chart.draw_series(comparison.motions.iter().step_by(2).map(|motion| {
        let from_s = motion.real_start_s.unwrap_or(motion.planned_start_s);
        let to_s = from_s + motion.real_s.unwrap_or(motion.planned_s);
        Rectangle::new([(from_s, 0.0), (to_s, top)], SHADE.mix(0.6).filled())
    }))?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 4")]
    let digits = (1.0 - top.log10().floor()).clamp(0.0, 4.0) as usize;
    mesh(&mut chart)
        .disable_x_mesh()
        .y_labels(5)
        .y_label_formatter(&|v| format!("{v:.digits$}"))
        .draw()?;
    for part in comparison.unbroken_trace() {
        let points = part.iter().map(|point| (start_s + point.measured_s, value(point)));
        chart.draw_series(LineSeries::new(points, MEASURED.stroke_width(3 * FINE / 2)))?;
    }
    Ok(())
}
