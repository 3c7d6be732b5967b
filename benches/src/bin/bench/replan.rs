//! Prints the number of replanned programs per second of a `Replanner` in which one motion changes,
//! and the difference of the cycle time from that of a plan from scratch, as a Markdown table. The
//! last rows are of the Sunrise application Palletising, most of whose motions lead to frames.

use std::{process::ExitCode, time::Instant};

use super::no_arguments::no_arguments;
use fastrand::Rng;
use iiwa_kin::Robot;
use iiwa_path::{JointPath, PathOptions};
use iiwa_program::{
    Blend, CartesianMotion, Course, LimitKind, Motion, MotionIndex, Program, Ptp, Target, TargetRef,
};
use iiwa_traj::{JerkOptions, Replanner, Timing, Trajectory};
use iiwasim_benches::{
    Result,
    long_program::{Kind, seeded},
    machine,
};

/// Number of motions per program, and number of programs.
const SIZES: [(usize, u64); 4] = [(10, 60), (100, 6), (1000, 1), (10_000, 1)];
/// Most motions of a program whose cycle time is compared with that of a plan from scratch.
const COMPARED: usize = 50;
/// Number of changes of each kind per program of that size.
const CHANGES: [usize; 4] = [10, 100, 600, 600];

/// Program of the application, as imported.
const PALLETISING: &str = include_str!("../../../../fixtures/sunrise/cell/expected.json");
/// Number of changes of each kind of that program.
const PALLETISING_CHANGES: u32 = 200;

/// Kind of change of a motion in joint space.
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
            measured.print(change.name(), motions);
        }
    }
    for change in FrameChange::ALL {
        let mut measured = Changed::default();
        let motions = measure_palletising(change, &mut measured)?;
        measured.print(change.name(), motions);
    }
    Ok(ExitCode::SUCCESS)
}

impl Changed {
    fn print(mut self, change: &str, motions: usize) {
        self.off_s.sort_by(f64::total_cmp);
        let mut sizes: Vec<_> = self.off_s.iter().map(|off| off.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        // Quantile in tenths.
        let quantile = |list: &[f64], tenths: usize| match list.len() {
            0 => "-".to_owned(),
            n => format!("{:.1e} s", list[(n - 1) * tenths / 10]),
        };
        println!(
            "| {change} | {motions} | {:.0} | {} | {} | {} | {} |",
            f64::from(self.changes) / self.time_s,
            quantile(&sizes, 5),
            quantile(&sizes, 9),
            quantile(&self.off_s, 10),
            quantile(&self.off_s, 0),
        );
    }

    /// Replaces a motion and measures the time.
    fn replace(&mut self, plan: &mut Replanner, motion: MotionIndex, new: Motion) -> Result<()> {
        let start = Instant::now();
        plan.replace(motion, new)?;
        let cycle_time_s = plan.cycle_time_s();
        self.time_s += start.elapsed().as_secs_f64();
        self.changes += 1;
        // Long programs change only locally, and are not compared.
        if plan.program().motions.len() <= COMPARED {
            let path = JointPath::new(plan.program(), plan.path().robot())?;
            let cold = Trajectory::plan(&path, Timing::Jerk(JerkOptions::default()))?;
            self.off_s.push(cycle_time_s - cold.cycle_time_s());
        }
        Ok(())
    }
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
        measured.replace(&mut plan, MotionIndex::new(index), Motion::Ptp(ptp))?;
    }
    Ok(())
}

/// Kind of change of a motion to a frame.
#[derive(Clone, Copy)]
enum FrameChange {
    /// E1 of the target, by up to 0.1 rad.
    E1,
    /// Height of the target, by up to 5 mm.
    Height,
    /// TCP velocity of a line, between 0.1 and 0.4 m/s.
    Speed,
    /// Blend radius, between 5 and 40 mm.
    Radius,
}

impl FrameChange {
    const ALL: [Self; 4] = [Self::E1, Self::Height, Self::Speed, Self::Radius];

    fn name(self) -> &'static str {
        match self {
            Self::E1 => "E1, with frames",
            Self::Height => "height, with frames",
            Self::Speed => "TCP speed, with frames",
            Self::Radius => "radius, with frames",
        }
    }

    /// Changes a motion; `false` if it has nothing to change.
    fn apply(self, motion: &mut CartesianMotion, rng: &mut Rng) -> bool {
        let mut between = |lower: f64, upper: f64| lower + (upper - lower) * rng.f64();
        let target = match &mut motion.course {
            Course::Ptp { to: TargetRef::Given(target) }
            | Course::Lin { to: TargetRef::Given(target) } => Some(target),
            _ => None,
        };
        match (self, target) {
            (Self::E1, Some(Target { e1_rad: Some(e1_rad), .. })) => *e1_rad += between(-0.1, 0.1),
            (Self::Height, Some(target)) => target.frame.xyz_mm[2] += between(-5.0, 5.0),
            (Self::Speed, _) if motion.tool_limits.way[LimitKind::Velocity].is_finite() => {
                motion.tool_limits.way[LimitKind::Velocity] = between(0.1, 0.4);
            }
            (Self::Radius, _) if motion.blend.is_some() => {
                motion.blend = Some(Blend::CartMm(between(5.0, 40.0)).into());
            }
            _ => return false,
        }
        true
    }
}

/// Changes the program of the application Palletising repeatedly, each time from the program as it
/// was imported. Returns its number of motions.
fn measure_palletising(change: FrameChange, measured: &mut Changed) -> Result<usize> {
    let program = Program::from_json(PALLETISING)?;
    let options = JerkOptions::default();
    let robot = program.with_flange(Robot::lbr_iiwa_7_r800());
    let mut plan = Replanner::new(program.clone(), &robot, PathOptions::default(), options)?;
    let mut rng = Rng::with_seed(7);
    while measured.changes < PALLETISING_CHANGES {
        let index = rng.usize(0..program.motions.len());
        let Motion::Cartesian(mut motion) = program.motions[index].clone() else { continue };
        if !change.apply(&mut motion, &mut rng) {
            continue;
        }
        let index = MotionIndex::new(index);
        measured.replace(&mut plan, index, Motion::Cartesian(motion))?;
        plan.replace(index, program.motions[index.index()].clone())?;
    }
    Ok(program.motions.len())
}
