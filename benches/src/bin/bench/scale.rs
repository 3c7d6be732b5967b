//! Prints the growth of time and memory with the length of a program, as Markdown tables: without
//! jerk limits, and with them.
//!
//! Each case runs in a separate process, which reports its peak memory.

use std::{
    env, fs,
    path::Path as FilePath,
    process::{Command, ExitCode, Output, Stdio},
    thread,
    time::{Duration, Instant},
};

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{Planner, SweepOptions, Timing};
use iiwasim_benches::{
    Result,
    long_program::{Kind, text},
    machine,
};
use serde::{Deserialize, Serialize};

const MOTIONS: [usize; 4] = [100, 1_000, 10_000, 100_000];
/// Numbers of motions with jerk limits.
const JERK_MOTIONS: [usize; 3] = [100, 1_000, 10_000];

/// Time limit of a case.
const MAX_DURATION: Duration = Duration::from_secs(30);

/// Report of a case's process.
#[derive(Deserialize, Serialize)]
struct Report {
    parse_ms: f64,
    path_ms: f64,
    plan_ms: f64,
    cycle_time_s: f64,
    /// Memory at the start, and its peak.
    memory_mb: [f64; 2],
}

pub(crate) fn run(arguments: &[&str]) -> Result<ExitCode> {
    match arguments {
        [] => {
            println!("On {}, {}.\n", machine::processor(), machine::instruction_level());
            print_table(Timing::Acceleration(SweepOptions::default()), &MOTIONS)?;
            println!("\nUnder jerk limits:\n");
            print_table(Timing::jerk_limited(), &JERK_MOTIONS)?;
        }
        ["--case", timing, file] => {
            let timings = [Timing::Acceleration(SweepOptions::default()), Timing::jerk_limited()];
            let timing = timings.into_iter().find(|known| known.name() == *timing);
            let report = measure(FilePath::new(file), timing.ok_or("no such timing")?)?;
            println!("{}", serde_json::to_string(&report)?);
        }
        _ => return Err("it takes no arguments".into()),
    }
    Ok(ExitCode::SUCCESS)
}

fn print_table(timing: Timing, lengths: &[usize]) -> Result<()> {
    let folder = tempfile::tempdir()?;
    println!(
        "| motions | blends | JSON | parse | path | plan | together | a motion | memory, at most |"
    );
    println!("|---:|---|---:|---:|---:|---:|---:|---:|---:|");
    for kind in Kind::ALL {
        for &motions in lengths {
            let file = folder.path().join("program.json");
            fs::write(&file, text(kind, motions))?;
            let mut case = Command::new(env::current_exe()?);
            case.args(["scale", "--case", timing.name()]).arg(&file);
            let Some(output) = within(MAX_DURATION, &mut case)? else {
                let most_s = MAX_DURATION.as_secs();
                println!("| {motions} | {} | | | | | more than {most_s} s | | |", kind.name());
                continue;
            };
            if !output.status.success() {
                let says = String::from_utf8_lossy(&output.stderr).into_owned();
                return Err(format!("{motions} motions, {}: {says}", kind.name()).into());
            }
            let report: Report = serde_json::from_slice(&output.stdout)?;
            let Report { parse_ms, path_ms, plan_ms, .. } = report;
            let all_ms = parse_ms + path_ms + plan_ms;
            println!(
                "| {motions} | {} | {:.1} MB | {parse_ms:.1} ms | {path_ms:.1} ms | {plan_ms:.1} \
                 ms | {all_ms:.1} ms | {:.1} us | {:.1} MB |",
                kind.name(),
                fs::metadata(&file)?.len() as f64 * 1e-6,
                1e3 * all_ms / motions as f64,
                report.memory_mb[1],
            );
        }
    }
    Ok(())
}

/// Returns the output of `command`; kills the process after `limit` and returns `None`.
fn within(limit: Duration, command: &mut Command) -> Result<Option<Output>> {
    let mut process = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let start = Instant::now();
    // The output is too short to fill a pipe.
    while process.try_wait()?.is_none() {
        if start.elapsed() > limit {
            process.kill()?;
            process.wait()?;
            return Ok(None);
        }
        thread::sleep(Duration::from_millis(5));
    }
    Ok(Some(process.wait_with_output()?))
}

fn measure(file: &FilePath, timing: Timing) -> Result<Report> {
    let idle_mb = machine::peak_memory_mb()?;
    let robot = Robot::lbr_iiwa_7_r800();
    let mut start = Instant::now();
    let mut lap_ms = || {
        let lap = start.elapsed();
        start = Instant::now();
        1e3 * lap.as_secs_f64()
    };
    let program = Program::from_json(&fs::read_to_string(file)?)?;
    let parse_ms = lap_ms();
    let path = JointPath::new(&program, &robot)?;
    drop(program);
    let path_ms = lap_ms();
    let mut cycle_time_s = 0.0;
    for section in Planner::new(&path, timing) {
        cycle_time_s = section?.end_s();
    }
    let plan_ms = lap_ms();
    let memory_mb = [idle_mb, machine::peak_memory_mb()?];
    Ok(Report { parse_ms, path_ms, plan_ms, cycle_time_s, memory_mb })
}
