//! Prints the number of programs that `plan_all` plans per second on one core and on all cores, as
//! a Markdown table.
//!
//! Other processes on the machine slow down all cores together more than a single one: efficiencies
//! are meaningful only on a quiet machine.

use std::{process::ExitCode, thread, time::Instant};

use super::no_arguments::no_arguments;
use iiwa_kin::Robot;
use iiwa_path::PathOptions;
use iiwa_program::Program;
use iiwa_traj::{PlanError, SweepOptions, Timing, Trajectory, plan_all};
use iiwasim_benches::{
    Result,
    long_program::{Kind, seeded},
    machine,
};
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Number of distinct programs: their planning times differ, which exercises load balancing.
const PROGRAMS: u64 = 300;
const MOTIONS: usize = 10;
/// Number of rounds, each on one core and then on all; the fastest of each counts.
const ROUNDS: usize = 5;
/// Minimum duration of a round, in s: a shorter round would end before all threads are awake.
const ROUND_S: f64 = 0.5;

pub(crate) fn run(arguments: &[&str]) -> Result<ExitCode> {
    no_arguments(arguments)?;
    let programs = (0..PROGRAMS)
        .map(|seed| Ok(Program::from_json(&seeded(Kind::Blended, MOTIONS, seed))?))
        .collect::<Result<Vec<_>>>()?;
    let cores = thread::available_parallelism()?.get();
    let pools = [pool(1)?, pool(cores)?];
    println!("On {}, {}.\n", machine::processor(), machine::instruction_level());
    println!("{PROGRAMS} programs of {MOTIONS} blended motions, from `Program` to `Trajectory`.\n");
    println!("| timing | on one core | on {cores} | speed-up | efficiency |");
    println!("|---|---:|---:|---:|---:|");
    for timing in [Timing::Acceleration(SweepOptions::default()), Timing::jerk_limited()] {
        let mut fastest_s = [f64::INFINITY; 2];
        for _ in 0..ROUNDS {
            for (pool, fastest_s) in pools.iter().zip(&mut fastest_s) {
                *fastest_s = fastest_s.min(round(pool, &programs, timing)?);
            }
        }
        let [one, all] = fastest_s.map(|time_s| programs.len() as f64 / time_s);
        println!(
            "| {} | {one:.0} programs/s | {all:.0} programs/s | {:.2} | {:.0} % |",
            timing.name(),
            all / one,
            100.0 * all / one / cores as f64,
        );
    }
    Ok(ExitCode::SUCCESS)
}

fn pool(threads: usize) -> Result<ThreadPool> {
    Ok(ThreadPoolBuilder::new().num_threads(threads).build()?)
}

/// Returns the time to plan all `programs` on the threads of `pool`, in s: the mean of a round's
/// calls.
fn round(pool: &ThreadPool, programs: &[Program], timing: Timing) -> Result<f64> {
    let robot = Robot::lbr_iiwa_7_r800();
    let (mut calls, mut time_s) = (0, 0.0);
    while time_s < ROUND_S {
        let start = Instant::now();
        let plans = pool.install(|| plan_all(programs, &robot, PathOptions::default(), timing));
        time_s += start.elapsed().as_secs_f64();
        calls += 1;
        // A failing program would appear to be fast.
        plans.into_iter().collect::<std::result::Result<Vec<Trajectory>, PlanError>>()?;
    }
    Ok(time_s / f64::from(calls))
}
