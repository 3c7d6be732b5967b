//! Baseline for the Python package: planning, sampling and forward kinematics in Rust alone.
//!
//!     native          medians as JSON, in us, of many rounds

use std::{
    error::Error,
    hint::black_box,
    io::{Write, stdout},
    time::Instant,
};

use iiwa_kin::{Pose, Robot};
use iiwa_plan::PlanOptions;
use iiwa_program::Program;

const POSES: usize = 100_000;

fn micros(rounds: usize, mut work: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..rounds)
        .map(|_| {
            let begin = Instant::now();
            work();
            1e6 * begin.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn main() -> Result<(), Box<dyn Error>> {
    let robot = Robot::default();
    let program = Program::from_json(include_str!("../../fixtures/ten-motions.json"))?;
    let options = PlanOptions::default();
    let trajectory = options.plan(&program, &robot)?;
    let plan_us = micros(41, || {
        black_box(options.plan(&program, &robot).is_ok());
    });
    let sample_us = micros(41, || {
        black_box(trajectory.samples(1000.0).collect::<Vec<_>>());
    });
    let joints: Vec<_> = (0..POSES).map(|i| [1e-5 * i as f64; 7]).collect();
    let fk_us = micros(21, || {
        let mut poses = vec![Pose::IDENTITY; POSES];
        robot.flange_pose_batch(&joints, &mut poses);
        black_box(poses);
    });
    let samples = trajectory.samples(1000.0).count();
    writeln!(
        stdout(),
        "{{\"plan_us\": {plan_us:.1}, \"sample_us\": {sample_us:.1}, \"samples\": {samples}, \
         \"fk_us\": {fk_us:.1}}}"
    )?;
    Ok(())
}
