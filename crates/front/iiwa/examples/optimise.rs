//! Plans many candidates for an intermediate pose and keeps the fastest.

use std::error::Error;
use std::io::{Write, stdout};

use iiwa::prelude::*;

/// Returns a program to the other side through an intermediate pose, which is blended.
fn by_way_of(shoulder_rad: f64, elbow_rad: f64) -> Program {
    let via = [0.0, shoulder_rad, 0.0, elbow_rad, 0.0, 0.7, 0.0];
    Program {
        robot: None,
        start: Start::Joints([0.8, 0.6, 0.0, -1.2, 0.0, 0.7, 0.0]),
        motions: vec![
            Motion::Ptp(Ptp::to(via).blend(Blend::Fraction(0.5))),
            Motion::Ptp(Ptp::to([-0.8, 0.6, 0.0, -1.2, 0.0, 0.7, 0.0])),
        ],
        workcell: Workcell::default(),
        sources: Sources::default(),
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    // A grid of intermediate poses; an optimiser would choose them based on earlier results.
    let candidates: Vec<(f64, f64)> = (0..20)
        .flat_map(|i| (0..20).map(move |j| (0.05 * f64::from(i), -0.1 * f64::from(j))))
        .collect();
    let programs: Vec<Program> =
        candidates.iter().map(|(shoulder, elbow)| by_way_of(*shoulder, *elbow)).collect();

    // Planned on all cores; the result of an infeasible candidate is its error.
    let robot = Robot::lbr_iiwa_7_r800();
    let plans = plan_all(&programs, &robot, PathOptions::default(), Timing::default());

    let ((shoulder, elbow), plan) = candidates
        .iter()
        .zip(&plans)
        .filter_map(|(candidate, plan)| Some((candidate, plan.as_ref().ok()?)))
        .min_by(|a, b| a.1.cycle_time_s().total_cmp(&b.1.cycle_time_s()))
        .ok_or("no candidate can be planned")?;
    writeln!(
        stdout(),
        "{} candidates; the fastest takes {:.3} s, with the shoulder at {shoulder:.2} rad and the \
         elbow at {elbow:.2} rad",
        candidates.len(),
        plan.cycle_time_s(),
    )?;
    Ok(())
}
