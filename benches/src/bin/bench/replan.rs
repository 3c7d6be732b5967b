//! Prints the number of replanned programs per second of a `Replanner` in which one motion changes,
//! and the difference of the cycle time from that of a plan from scratch, as Markdown tables.

use std::{process::ExitCode, time::Instant};

use super::no_arguments::no_arguments;
use fastrand::Rng;
use iiwa_kin::Robot;
use iiwa_path::{JointPath, PathOptions};
use iiwa_program::{Blend, Motion, MotionIndex, Program, Ptp};
use iiwa_traj::{JerkOptions, Replanner, Timing, Trajectory};
use iiwasim_benches::{
    Result,
    long_program::{Kind, seeded},
    machine,
};

/// Number of motions per program, and number of programs.
const SIZES: [(usize, u64); 4] = [(10, 60), (100, 6), (1000, 1), (10_000, 1)];
/// Number of changes of each kind per program of that size.
const CHANGES: [usize; 4] = [10, 100, 600, 600];

/// Kind of change.
#[derive(Clone, Copy)]
enum Change {
    /// Each joint of a target, by up to 0.1 rad.
    Target,
    /// Relative velocity, between 0.2 and 1.
    Speed,
    /// Blend, between 0.05 and 0.45 of the adjacent segments.
    Radius,
}

impl Change {
    const ALL: [Self; 3] = [Self::Target, Self::Speed, Self::Radius];

    fn name(self) -> &'static str {
        match self {
            Self::Target => "target",
            Self::Speed => "speed",
            Self::Radius => "radius",
        }
    }

    fn apply(self, ptp: &mut Ptp, rng: &mut Rng) {
        let mut between = |lower: f64, upper: f64| lower + (upper - lower) * rng.f64();
        match self {
            Self::Target => ptp.target_rad.iter_mut().for_each(|q| *q += between(-0.1, 0.1)),
            Self::Speed => ptp.velocity_rel = [between(0.2, 1.0); 7],
            Self::Radius => ptp.blend = Some(Blend::Fraction(between(0.05, 0.45))),
        }
    }
}

/// Measurements of one kind of change in programs of one size.
#[derive(Default)]
struct Changed {
    changes: u32,
    time_s: f64,
    /// Differences of cycle times from those of plans from scratch, in s.
    off_s: Vec<f64>,
}

pub(crate) fn run(arguments: &[&str]) -> Result<ExitCode> {
    no_arguments(arguments)?;
    println!("On {}, {}.\n", machine::processor(), machine::instruction_level());
    println!(
        "| change | motions | changes/s | off a plan from nothing: median | 90 % | slowest | \
         fastest |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|");
    for change in Change::ALL {
        for (&(motions, programs), &changes) in SIZES.iter().zip(&CHANGES) {
            let mut measured = Changed::default();
            for seed in 0..programs {
                measure(change, motions, seed, changes, &mut measured)?;
            }
            let Changed { changes, time_s, mut off_s } = measured;
            off_s.sort_by(f64::total_cmp);
            let mut sizes: Vec<_> = off_s.iter().map(|off| off.abs()).collect();
            sizes.sort_by(f64::total_cmp);
            // Quantile in tenths.
            let quantile = |list: &[f64], tenths: usize| match list.len() {
                0 => "-".to_owned(),
                n => format!("{:.1e} s", list[(n - 1) * tenths / 10]),
            };
            println!(
                "| {} | {motions} | {:.0} | {} | {} | {} | {} |",
                change.name(),
                f64::from(changes) / time_s,
                quantile(&sizes, 5),
                quantile(&sizes, 9),
                quantile(&off_s, 10),
                quantile(&off_s, 0),
            );
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Changes a program repeatedly.
fn measure(
    change: Change,
    motions: usize,
    seed: u64,
    changes: usize,
    measured: &mut Changed,
) -> Result<()> {
    let robot = Robot::lbr_iiwa_7_r800();
    let program = Program::from_json(&seeded(Kind::Blended, motions, seed))?;
    let options = JerkOptions::default();
    let mut plan = Replanner::new(program, &robot, PathOptions::default(), options)?;
    let mut rng = Rng::with_seed(seed);
    for _ in 0..changes {
        let index = rng.usize(0..motions - 1);
        let Motion::Ptp(mut ptp) = plan.program().motions[index].clone() else { continue };
        change.apply(&mut ptp, &mut rng);
        let start = Instant::now();
        plan.replace(MotionIndex::new(index), Motion::Ptp(ptp))?;
        let cycle_time_s = plan.cycle_time_s();
        measured.time_s += start.elapsed().as_secs_f64();
        measured.changes += 1;
        // Long programs change only locally, and are not compared.
        if motions <= 10 {
            let path = JointPath::new(plan.program(), &robot)?;
            let cold = Trajectory::plan(&path, Timing::Jerk(options))?;
            measured.off_s.push(cycle_time_s - cold.cycle_time_s());
        }
    }
    Ok(())
}
