//! Moves one target at a time to reduce the cycle time of the whole program, like an optimiser.

use std::error::Error;
use std::io::{Write, stdout};

use iiwa::prelude::*;

/// First step of a joint of a target, in rad, and number of halvings of the step.
const STEP_RAD: f64 = 0.2;
const HALVINGS: u32 = 4;

fn main() -> Result<(), Box<dyn Error>> {
    // Back and forth between two machines, around a post: the targets in between are free.
    let pass = |sweep: f64, elbow: f64| {
        Motion::Ptp(Ptp::to([sweep, 0.5, 0.0, elbow, 0.0, 0.7, 0.0]).blend(Blend::Fraction(0.4)))
    };
    let motions: Vec<_> = (0..20)
        .flat_map(|_| [pass(0.3, -1.9), pass(-0.9, -1.0), pass(0.1, -1.7), pass(0.9, -1.0)])
        .chain([Motion::Ptp(Ptp::to([0.9, 0.5, 0.0, -1.0, 0.0, 0.7, 0.0]))])
        .collect();
    let start_rad = [0.9, 0.5, 0.0, -1.0, 0.0, 0.7, 0.0];
    let program = Program {
        robot: None,
        start: Start::Joints(start_rad),
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let robot = Robot::lbr_iiwa_7_r800();
    let mut plan = Replanner::new(program, &robot, PathOptions::default(), JerkOptions::default())?;

    let before_s = plan.cycle_time_s();
    let mut tried = 0;
    for halving in 0..HALVINGS {
        let step_rad = STEP_RAD / f64::from(1 << halving);
        // The elbow joint of the intermediate targets.
        for index in (0..80).step_by(2) {
            for way in [step_rad, -step_rad] {
                let best_s = plan.cycle_time_s();
                let old = plan.program().motions[index].clone();
                let Motion::Ptp(mut ptp) = old.clone() else { continue };
                ptp.target_rad[3] += way;
                tried += 1;
                // An infeasible target leaves the plan unchanged; a slower one is undone.
                let changed = plan.replace(MotionIndex::new(index), Motion::Ptp(ptp));
                if changed.is_ok() && plan.cycle_time_s() > best_s {
                    plan.replace(MotionIndex::new(index), old)?;
                }
            }
        }
    }
    writeln!(
        stdout(),
        "{tried} changes of 81 motions: {before_s:.3} s before, {:.3} s after",
        plan.cycle_time_s(),
    )?;
    Ok(())
}
