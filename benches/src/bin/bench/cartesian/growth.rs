//! Growth of planning time with the number of lines.

use std::time::Instant;

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::{CartesianMotion, Course, Frame, Motion, PathBlend, Program, ProgramBuilder};
use iiwa_traj::{Planner, SweepOptions, Timing};
use iiwasim_benches::Result;

/// Start pose, away from all singularities, with room for the star around it.
const START_DEG: [f64; 7] = [0.0, 20.0, 0.0, -110.0, 0.0, -40.0, 90.0];
/// Number of tips of the star per turn, alternating between outside and inside.
const TIPS: usize = 40;
/// Distances of the tips from the centre, in mm.
const RADII_MM: [f64; 2] = [80.0, 100.0];
/// Minimum number of planned programs per length, and minimum number of planned motions.
const MIN_RUNS: usize = 3;
const MOTIONS: usize = 300;

/// Prints a table for programs of these numbers of motions.
pub(crate) fn print(lengths: &[usize]) -> Result<()> {
    println!("### growth\n");
    println!(
        "LINs around a star in a vertical plane, {TIPS} tips, each line some 24 mm: with blends of \
         `cart_mm` 5, and with stops. Time a motion, the fastest of at least {MIN_RUNS} runs, \
         section by section.\n"
    );
    println!("| motions | | path | acceleration | jerk | jerk, over that of the first row |");
    println!("|---:|---|---:|---:|---:|---:|");
    for blend in [Some(PathBlend::cart_mm(5.0)), None] {
        let mut first_us = None;
        for &motions in lengths {
            let us = measure(&star(motions, blend), motions)?;
            let [path_us, acceleration_us, jerk_us] = us;
            let first_us = *first_us.get_or_insert(jerk_us);
            println!(
                "| {motions} | {} | {path_us:.1} us | {acceleration_us:.1} us | {jerk_us:.1} us | \
                 {:.2} |",
                if blend.is_some() { "blended" } else { "stops" },
                jerk_us / first_us,
            );
        }
    }
    Ok(())
}

/// Returns a program with lines from tip to tip.
fn star(motions: usize, blend: Option<PathBlend>) -> Program {
    let start_rad = START_DEG.map(f64::to_radians);
    let pose = Robot::lbr_iiwa_7_r800().flange_pose(&start_rad);
    let start = Frame::from(&pose);
    let lines = (1..=motions).map(|i| {
        let turned = (i % TIPS) as f64 / TIPS as f64 * std::f64::consts::TAU;
        let radius_mm = RADII_MM[i % 2];
        let [x, y, z] = start.xyz_mm;
        let (sin, cos) = turned.sin_cos();
        // The first tip is close to the start of the arm.
        let place = [x, y + radius_mm * sin, z + radius_mm * cos - RADII_MM[0]];
        let to = Frame { xyz_mm: place, ..start };
        let blend = blend.filter(|_| i < motions);
        CartesianMotion { blend, ..CartesianMotion::new(Course::Lin { to: to.into() }) }
    });
    let program = Program::from_rad(start_rad);
    let add = |program: ProgramBuilder, line| program.motion(Motion::Cartesian(Box::new(line)));
    lines.fold(program, add).build()
}

/// Returns the times per motion for the path and both plans, in us.
fn measure(program: &Program, motions: usize) -> Result<[f64; 3]> {
    let robot = Robot::lbr_iiwa_7_r800();
    let mut fastest_s = [f64::INFINITY; 3];
    let timings = [Timing::Acceleration(SweepOptions::default()), Timing::jerk_limited()];
    for _ in 0..MIN_RUNS.max(MOTIONS / motions) {
        let mut start = Instant::now();
        let path = JointPath::new(program, &robot)?;
        let mut times_s = [start.elapsed().as_secs_f64(), 0.0, 0.0];
        for (time_s, timing) in times_s[1..].iter_mut().zip(timings) {
            start = Instant::now();
            for section in Planner::new(&path, timing) {
                section?;
            }
            *time_s = start.elapsed().as_secs_f64();
        }
        for (fastest_s, time_s) in fastest_s.iter_mut().zip(times_s) {
            *fastest_s = fastest_s.min(time_s);
        }
    }
    Ok(fastest_s.map(|time_s| 1e6 * time_s / motions as f64))
}
