//! Compares instruction counts with `benches/baseline.json`, and fails if one has grown.
//!
//! The counts are those of callgrind. Each workload runs a few times and then more often, in
//! separate processes: the difference is due to the workload alone. Counts depend on the
//! instruction level that the crates detect, so the baseline contains one set per level.
//!
//! `cargo run --release -p iiwasim-benches --bin gate`; with `-- --renew` it writes the baseline.
#![expect(clippy::print_stdout, reason = "a table is what it is for")]

use std::{
    collections::BTreeMap,
    env, fs,
    hint::black_box,
    process::{Command, ExitCode},
};

use iiwa_kin::{Load, PathTorques, Pose, Robot};
use iiwa_path::{BlendSearch, JointPath, PathOptions};
use iiwa_program::{Motion, MotionIndex, Program};
use iiwa_traj::{JerkOptions, Limit, LimitShare, Replanner, SweepOptions, Timing, Trajectory};
use iiwasim_benches::{
    Result,
    joints::{poses, ptp_paths},
    long_program::{self, Kind},
    machine, reference,
};
use serde::{Deserialize, Serialize};

const BASELINE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/baseline.json");
/// Largest accepted growth.
const TOLERANCE: f64 = 0.05;
/// Counts by instruction level.
type Baseline = BTreeMap<String, Counts>;

#[derive(Deserialize, Serialize)]
struct Counts {
    /// Tool versions of the counts.
    rustc: String,
    valgrind: String,
    /// Instructions of one run of each workload.
    instructions: BTreeMap<String, u64>,
}

#[derive(Clone, Copy)]
enum Workload {
    Forward,
    ForwardBatch,
    BlendSearch,
    Sweep,
    Plan,
    Jerk,
    LongJerk,
    Sunrise,
    Ptp,
    ShortPtp,
    Replan,
    Torques,
    TorquesBatch,
    PathTorques,
    TorqueLimits,
}

impl Workload {
    const ALL: [Self; 15] = [
        Self::Forward,
        Self::ForwardBatch,
        Self::BlendSearch,
        Self::Sweep,
        Self::Plan,
        Self::Jerk,
        Self::LongJerk,
        Self::Sunrise,
        Self::Ptp,
        Self::ShortPtp,
        Self::Replan,
        Self::Torques,
        Self::TorquesBatch,
        Self::PathTorques,
        Self::TorqueLimits,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward kinematics, 1000 poses",
            Self::ForwardBatch => "forward kinematics, batch of 1000",
            Self::BlendSearch => "blend search, 54 first crossings",
            Self::Sweep => "stamps of ten motions",
            Self::Plan => "ten motions from JSON to stamps",
            Self::Jerk => "stamps of ten motions, jerk-limited",
            Self::LongJerk => "stamps of 100 motions, jerk-limited",
            Self::Sunrise => "stamps of ten motions, Sunrise",
            Self::Ptp => "stamps of 100 PTP motions of 2 rad, Sunrise",
            Self::ShortPtp => "stamps of 100 PTP motions of 0.2 rad, Sunrise",
            Self::Replan => "a target of 100 motions moves, jerk-limited",
            Self::Torques => "inverse dynamics, 1000 poses",
            Self::TorquesBatch => "inverse dynamics, batch of 1000",
            Self::PathTorques => "torques along a path, batch of 1000",
            Self::TorqueLimits => "stamps of ten motions with a load, jerk- and torque-limited",
        }
    }

    /// Upper bound on instructions, independent of the baseline: for inverse dynamics 2000 per pose
    /// one by one, and 1100 in a batch; with active torque limits, twice the time parameterisation
    /// without them.
    fn limit(self, counts: &BTreeMap<String, u64>) -> Option<u64> {
        match self {
            Self::Torques => Some(2_000_000),
            Self::TorquesBatch => Some(1_100_000),
            Self::TorqueLimits => counts.get(Self::Jerk.name()).map(|without| 2 * without),
            _ => None,
        }
    }

    /// Number of runs in the shorter and in the longer process: more for fast workloads, so that
    /// one-time work cancels.
    fn runs(self) -> [u64; 2] {
        match self {
            Self::LongJerk => [1, 2],
            _ => [2, 12],
        }
    }

    fn run(self, runs: u64) -> Result<()> {
        let robot = Robot::lbr_iiwa_7_r800();
        match self {
            Self::Forward => {
                let joints = poses(&robot, 1000);
                for q in (0..runs).flat_map(|_| &joints) {
                    black_box(robot.flange_pose(black_box(q)));
                }
            }
            Self::ForwardBatch => {
                let joints = poses(&robot, 1000);
                let mut poses = vec![Pose::IDENTITY; joints.len()];
                for _ in 0..runs {
                    robot.flange_pose_batch(black_box(&joints), black_box(&mut poses));
                }
            }
            Self::Torques => {
                let (joints, dynamics) = (poses(&robot, 1000), robot.dynamics());
                for q in (0..runs).flat_map(|_| &joints) {
                    black_box(dynamics.torques(black_box(q), black_box(q), black_box(q)));
                }
            }
            Self::TorquesBatch => {
                let (joints, dynamics) = (poses(&robot, 1000), robot.dynamics());
                let mut positions = vec![[0.0; 7]; joints.len()];
                for _ in 0..runs {
                    let joints = black_box(&joints);
                    dynamics.torques_batch(joints, joints, joints, black_box(&mut positions));
                }
            }
            Self::PathTorques => {
                let (joints, dynamics) = (poses(&robot, 1000), robot.dynamics());
                let mut torques = vec![PathTorques::default(); joints.len()];
                for _ in 0..runs {
                    let joints = black_box(&joints);
                    dynamics.path_torques_batch(joints, joints, joints, black_box(&mut torques));
                }
            }
            Self::TorqueLimits => plan_with_torque_limits(&robot, runs)?,
            Self::BlendSearch => {
                let searches = reference::searches()?;
                for search in (0..runs).flat_map(|_| &searches) {
                    black_box(black_box(search).run(BlendSearch::FirstCrossing, &robot));
                }
            }
            Self::Sweep => {
                let program = Program::from_json(&reference::ten_motions()?)?;
                let path = JointPath::new(&program, &robot)?;
                for _ in 0..runs {
                    black_box(Trajectory::plan(
                        black_box(&path),
                        Timing::Acceleration(SweepOptions::default()),
                    )?);
                }
            }
            Self::Ptp => plan_ptps(&robot, 2.0, runs)?,
            Self::ShortPtp => plan_ptps(&robot, 0.2, runs)?,
            Self::Jerk | Self::Sunrise | Self::LongJerk => {
                let text = match self {
                    Self::LongJerk => long_program::text(Kind::Blended, 100),
                    _ => reference::ten_motions()?,
                };
                let path = JointPath::new(&Program::from_json(&text)?, &robot)?;
                let timing = match self {
                    Self::Sunrise => Timing::Sunrise(JerkOptions::default()),
                    _ => Timing::jerk_limited(),
                };
                for _ in 0..runs {
                    black_box(Trajectory::plan(black_box(&path), timing)?);
                }
            }
            Self::Replan => {
                let program = Program::from_json(&long_program::text(Kind::Blended, 100))?;
                let options = JerkOptions::default();
                let mut plan = Replanner::new(program, &robot, PathOptions::default(), options)?;
                let moved = MotionIndex::new(50);
                for run in 0..runs {
                    let mut motion = plan.program().motions[moved.index()].clone();
                    if let Motion::Ptp(ptp) = &mut motion {
                        ptp.target_rad[0] += if run % 2 == 0 { 0.05 } else { -0.05 };
                    }
                    plan.replace(moved, black_box(motion))?;
                    black_box(plan.cycle_time_s());
                }
            }
            Self::Plan => {
                let text = reference::ten_motions()?;
                for _ in 0..runs {
                    let program = Program::from_json(black_box(&text))?;
                    let path = JointPath::new(&program, &robot)?;
                    black_box(Trajectory::plan(
                        &path,
                        Timing::Acceleration(SweepOptions::default()),
                    )?);
                }
            }
        }
        Ok(())
    }
}

/// Plans 100 single PTP motions with one length in joint space.
fn plan_ptps(robot: &Robot, length_rad: f64, runs: u64) -> Result<()> {
    let paths = ptp_paths(robot, 100, length_rad)?;
    for path in (0..runs).flat_map(|_| &paths) {
        black_box(Trajectory::plan(black_box(path), Timing::Sunrise(JerkOptions::default()))?);
    }
    Ok(())
}

/// Plans ten motions with a load for which torque limits are active.
fn plan_with_torque_limits(robot: &Robot, runs: u64) -> Result<()> {
    let mut program = Program::from_json(&reference::ten_motions()?)?;
    let load = Load { mass_kg: 7.0, center_mm: [0.0, 0.0, 60.0], ..Load::default() };
    program.motions.insert(0, Motion::Load(Some(load.into())));
    program.workcell.torque_limit_rel = Some(0.8);
    let path = JointPath::new(&program, robot)?;
    for _ in 0..runs {
        let plan = Trajectory::plan(black_box(&path), Timing::jerk_limited())?;
        let is_torque = |limit: &LimitShare| matches!(limit.limit, Limit::Torque(_));
        if !plan.motions().iter().any(|motion| motion.limits.iter().any(is_torque)) {
            return Err("no torque holds these motions back".into());
        }
    }
    Ok(())
}

fn main() -> Result<ExitCode> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments.as_slice() {
        [] => check(),
        ["--renew"] => renew(),
        // Arguments of the counted processes.
        ["--level"] => {
            println!("{}", machine::instruction_level());
            Ok(ExitCode::SUCCESS)
        }
        ["--run", workload, runs] => {
            Workload::ALL[workload.parse::<usize>()?].run(runs.parse()?)?;
            Ok(ExitCode::SUCCESS)
        }
        _ => Err("it takes no arguments but --renew".into()),
    }
}

fn check() -> Result<ExitCode> {
    let level = counted(&["--level"])?.prints;
    let baseline = baseline()?;
    let Some(expected) = baseline.get(&level) else {
        let known: Vec<_> = baseline.keys().map(String::as_str).collect();
        println!(
            "NOT CHECKED: no baseline for {level}, only for {}. `gate --renew` adds one.",
            known.join(", ")
        );
        return Ok(ExitCode::SUCCESS);
    };
    let instructions = count()?;
    println!("Instructions, {level}. A growth above {:.0} % fails.\n", 100.0 * TOLERANCE);
    println!("| workload | baseline | now | change | |");
    println!("|---|---:|---:|---:|---|");
    let (mut grown, mut shrunk, mut missing) = (false, false, false);
    for (name, &now) in &instructions.instructions {
        let Some(&before) = expected.instructions.get(name) else {
            println!("| {name} | none | {now} | | not checked |");
            missing = true;
            continue;
        };
        let change = now as f64 / before as f64 - 1.0;
        let verdict = if change > TOLERANCE {
            grown = true;
            "**grown**"
        } else if change < -TOLERANCE {
            shrunk = true;
            "shrunk"
        } else {
            "kept"
        };
        println!("| {name} | {before} | {now} | {:+.2} % | {verdict} |", 100.0 * change);
    }
    let mut is_above = false;
    for workload in Workload::ALL {
        let now = instructions.instructions.get(workload.name());
        if let (Some(now), Some(limit)) = (now, workload.limit(&instructions.instructions)) {
            is_above |= *now > limit;
            println!("\n{}: {now} of at most {limit}", workload.name());
        }
    }
    if expected.rustc != instructions.rustc {
        println!(
            "\nThe baseline is by {}, the figures are by {}.",
            expected.rustc, instructions.rustc
        );
    }
    if is_above {
        println!("\nAbove what it may take: this growth cannot be renewed.");
    }
    if grown {
        println!("\nIf the growth is meant: `gate --renew`, and say why in the commit.");
    }
    if grown || is_above {
        return Ok(ExitCode::FAILURE);
    }
    if shrunk || missing {
        println!("\n`gate --renew` makes these the baseline.");
    }
    Ok(ExitCode::SUCCESS)
}

fn renew() -> Result<ExitCode> {
    let level = counted(&["--level"])?.prints;
    let mut baseline = baseline()?;
    let counts = count()?;
    for (name, count) in &counts.instructions {
        println!("{name}: {count}");
    }
    baseline.insert(level.clone(), counts);
    fs::write(BASELINE, serde_json::to_string_pretty(&baseline)? + "\n")?;
    println!("{BASELINE} now holds these for {level}");
    Ok(ExitCode::SUCCESS)
}

fn baseline() -> Result<Baseline> {
    match fs::read_to_string(BASELINE) {
        Ok(text) => Ok(serde_json::from_str(&text)?),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Baseline::new()),
        Err(error) => Err(format!("{BASELINE}: {error}").into()),
    }
}

/// Counts all workloads.
fn count() -> Result<Counts> {
    let mut instructions = BTreeMap::new();
    for (i, workload) in Workload::ALL.iter().enumerate() {
        let run = |runs: u64| counted(&["--run", &i.to_string(), &runs.to_string()]);
        let [few, many] = workload.runs();
        let difference = run(many)?.instructions.saturating_sub(run(few)?.instructions);
        instructions.insert(workload.name().to_owned(), difference / (many - few));
    }
    Ok(Counts {
        rustc: machine::version("rustc"),
        valgrind: machine::version("valgrind"),
        instructions,
    })
}

struct Counted {
    prints: String,
    instructions: u64,
}

/// Runs this program with `arguments` under callgrind.
fn counted(arguments: &[&str]) -> Result<Counted> {
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]);
    let output = match valgrind.arg(env::current_exe()?).args(arguments).output() {
        Ok(output) => output,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            return Err("valgrind is missing; install it (`apt install valgrind`)".into());
        }
        Err(error) => return Err(format!("valgrind: {error}").into()),
    };
    let says = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        return Err(format!("under valgrind: {}\n{says}", output.status).into());
    }
    let collected = says.lines().find_map(|line| line.split_once("Collected :"));
    let (_, collected) = collected.ok_or_else(|| format!("valgrind gave no count:\n{says}"))?;
    Ok(Counted {
        prints: String::from_utf8_lossy(&output.stdout).trim().to_owned(),
        instructions: collected.trim().parse()?,
    })
}
