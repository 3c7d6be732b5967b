//! Holds a recording at 1 kHz against its plan, and says how soon it is done and how much memory that
//! takes, reading both included.
//!
//! `compare [MINUTES]`, 5 by default. An hour takes 4 GB in the folder for temporary files.
#![expect(clippy::print_stdout, reason = "figures are what it is for")]

use std::{
    collections::BTreeMap,
    env,
    fs::{self, File},
    io::BufWriter,
    path::Path as FilePath,
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use iiwa_eval::{Plan, compare};
use iiwa_kin::Robot;
use iiwa_log::{JointLog, PlanConfig, PlanWriter, Recorder, RecorderConfig};
use iiwa_path::{Path, Program};
use iiwa_traj::{Timing, Trajectory};
use iiwasim_benches::{
    Result,
    long_program::{self, Kind},
    machine,
};

const RATE_HZ: u32 = 1000;

/// Motions a minute of the program that is recorded, about.
const MOTIONS_A_MINUTE: usize = 60;

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    if let [flag, plan, measured] = arguments.as_slice()
        && flag == "--compare"
    {
        return hold(FilePath::new(plan), FilePath::new(measured));
    }
    let minutes: usize = arguments.first().map_or(Ok(5), |text| text.parse())?;
    println!("On {}, {}.", machine::processor(), machine::instruction_level());
    let folder = tempfile::tempdir()?;
    let [plan, measured] = ["plan.mcap", "measured.mcap"].map(|name| folder.path().join(name));
    write(minutes, &plan, &measured)?;
    // A process of its own: the most memory that it ever held is that of comparing.
    let status = Command::new(env::current_exe()?)
        .arg("--compare")
        .args([&plan, &measured])
        .stdin(Stdio::null())
        .status()?;
    if status.success() { Ok(()) } else { Err("comparing failed".into()) }
}

/// Compares and reports.
fn hold(plan: &FilePath, measured: &FilePath) -> Result<()> {
    let begin = Instant::now();
    let plan = Plan::read_mcap(File::open(plan)?, None)?;
    let plan_s = begin.elapsed().as_secs_f64();
    let measured = JointLog::read(File::open(measured)?)?;
    let read_s = begin.elapsed().as_secs_f64();
    let comparison = compare(&plan, &measured)?;
    let all_s = begin.elapsed().as_secs_f64();
    println!(
        "{} motions, {:.0} s of motion, {} samples: {plan_s:.2} s to read the plan, {:.2} s to read the \
         recording, {:.2} s to compare; {all_s:.2} s in all, with {:.0} MB of memory",
        comparison.motions.len(),
        comparison.cycle_time.real_s,
        comparison.samples,
        read_s - plan_s,
        all_s - read_s,
        machine::peak_memory_mb()?,
    );
    let (off_s, off_m) = (comparison.cycle_time.error_s, comparison.tcp_m.max);
    println!(
        "The recording is of the plan itself: off by {off_s:.1e} s and {:.1e} mm",
        1e3 * off_m
    );
    Ok(())
}

/// Writes a plan and a recording of it, with a pause before and after.
fn write(minutes: usize, plan: &FilePath, measured: &FilePath) -> Result<()> {
    let robot = Robot::lbr_iiwa_7_r800();
    let program = Program::from_json(&long_program::text(Kind::Stops, minutes * MOTIONS_A_MINUTE))?;
    let trajectory = Trajectory::plan(&Path::new(&program, &robot)?, Timing::default())?;
    let stream = BufWriter::new(File::create(plan)?);
    let mut writer = PlanWriter::new(stream, &robot, PlanConfig::default())?;
    for stretch in trajectory.stretches() {
        writer.stretch(stretch)?;
    }
    let metadata = BTreeMap::from([("robot".to_owned(), robot.name().to_owned())]);
    writer.finish(&metadata, &[])?;

    let config = RecorderConfig { period: Duration::from_secs(10), ..RecorderConfig::default() };
    let mut recorder = Recorder::new(File::create(measured)?, &robot, config)?;
    for k in 0.. {
        let t = Duration::from_secs(1) / RATE_HZ * k;
        if t.as_secs_f64() > trajectory.cycle_time_s() + 4.0 {
            break;
        }
        recorder.sample(t, &trajectory.at(t.as_secs_f64() - 2.0).q)?;
    }
    recorder.finish(&BTreeMap::new(), &[])?;
    println!(
        "{:.0} MB of plan, {:.0} MB of recording",
        fs::metadata(plan)?.len() as f64 / 1e6,
        fs::metadata(measured)?.len() as f64 / 1e6
    );
    Ok(())
}
