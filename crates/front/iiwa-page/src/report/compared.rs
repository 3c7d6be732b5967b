//! Comparison of a recording with a plan, for the page.

use std::path::Path;

use iiwa_eval::{Comparison, MotionTime, PlannedTrajectory, TracePoint};
use iiwa_kin::Robot;
use iiwa_log::PlanPiece;
use iiwa_report::{ComparisonReport, with_causes};
use serde::Serialize;

use super::{
    curve::{CurveColumns, TimeSeries},
    source::{PageSource, Role},
};

/// Comparison of a recording with a plan.
#[derive(Serialize)]
pub(crate) struct Compared {
    /// Report, as in `iiwasim compare --json`.
    pub(crate) report: ComparisonReport,
    /// Deviations of recorded samples, over the page's time.
    tcp_mm: CurveColumns,
    joints_mrad: CurveColumns,
}

impl std::fmt::Debug for Compared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Compared").field("tcp_mm", &self.tcp_mm).finish_non_exhaustive()
    }
}

/// Compares the recording with the plan; returns also the time shift from the recording to the
/// plan, and the times of the motions, or the reason for failure.
pub(crate) fn comparison(
    first: &PageSource,
    second: &PageSource,
    robot: &Robot,
) -> Result<(Compared, f64, Vec<MotionTime>), String> {
    let not = |why: String| format!("not compared, both start at 0: {why}");
    if first.role() != Role::Plan || first.is_broken_off() {
        return Err(not(format!("{} is not a whole plan", first.name)));
    }
    let plan = PlannedTrajectory::from_record(first.record.clone(), Some(robot.clone()))
        .map_err(|error| not(with_causes(&error)))?;
    let comparison: Comparison = iiwa_eval::compare(&plan, &second.log)
        .map_err(|error| not(format!("{}: {}", second.name, with_causes(&error))))?;
    let moves = |piece: &&PlanPiece| piece.kind.moves();
    let start_s = first.record.pieces.iter().find(moves).map_or(0.0, |piece| piece.start_s);
    let names = [Path::new(&first.name), Path::new(&second.name)];
    let compared = Compared {
        report: ComparisonReport::new(names, None, &plan, &second.log, &comparison),
        tcp_mm: deviation(&comparison, start_s, |point| 1e3 * point.flange_deviation_m),
        joints_mrad: deviation(&comparison, start_s, |point| 1e3 * point.joints_rad),
    };
    Ok((compared, start_s - comparison.departure_s, comparison.motions))
}

/// Returns a deviation over the time of the recording, which continues during pauses of the plan's
/// time; the arm starts at `start_s`.
fn deviation(
    comparison: &Comparison,
    start_s: f64,
    value: impl Fn(&TracePoint) -> f64,
) -> CurveColumns {
    let mut samples = TimeSeries::<1>::with_capacity(comparison.trace.len());
    for part in comparison.unbroken_trace() {
        if let (Some(last), Some(first)) = (samples.t_s.last(), part.first()) {
            let middle_s = f64::midpoint(*last, start_s + first.measured_s);
            samples.push(middle_s, [f64::NAN]);
        }
        for point in part {
            samples.push(start_s + point.measured_s, [value(point)]);
        }
    }
    CurveColumns::new(&samples, 0.0)
}
