//! Records a long program at 1 kHz, and prints the time and memory for reading the recording,
//! comparing it with its plan, and identifying the robot from it.
//!
//! `bench recording [MINUTES]`, 5 by default. An hour takes 5 GB in the folder for temporary files.
//!
//! Each job runs in a separate process, which reports its peak memory.

use std::{
    collections::BTreeMap,
    env,
    fs::{self, File},
    io::BufWriter,
    path::Path as FilePath,
    process::{Command, ExitCode, Stdio},
    time::{Duration, Instant},
};

use fastrand_contrib::RngExt;
use iiwa_eval::{
    PlannedTrajectory, compare,
    identify::{RecordedRun, identify},
};
use iiwa_kin::Robot;
use iiwa_log::{JointLog, PlanConfig, Recorder, RecorderConfig, write_plan};
use iiwa_plan::{PlanRequest, ProgramSource};
use iiwa_program::Program;
use iiwasim_benches::{
    Result,
    long_program::{self, Kind},
    machine,
};

const RATE_HZ: u32 = 1000;

/// Approximate number of motions per minute in the recorded program.
const MOTIONS_A_MINUTE: usize = 60;

/// Standard deviation of the noise of each joint.
const NOISE_RAD: f64 = 1e-5;

const PROGRAM: &str = "program.json";
const PLAN: &str = "plan.mcap";
const MCAP: &str = "recording.mcap";
const CSV: &str = "recording.csv";

pub(crate) fn run(arguments: &[&str]) -> Result<ExitCode> {
    if let [job, folder] = arguments {
        let begin = Instant::now();
        let message = run_job(job, FilePath::new(folder))?;
        let spent_s = begin.elapsed().as_secs_f64();
        let memory_mb = machine::peak_memory_mb()?;
        println!("{message}: {spent_s:.2} s in all, with {memory_mb:.0} MB of memory");
        return Ok(ExitCode::SUCCESS);
    }
    let minutes: usize = arguments.first().map_or(Ok(5), |text| text.parse())?;
    println!("On {}, {}.", machine::processor(), machine::instruction_level());
    let folder = tempfile::tempdir()?;
    write(minutes, folder.path())?;
    for job in ["--read", "--read-csv", "--compare", "--identify"] {
        let status = Command::new(env::current_exe()?)
            .args(["recording", job])
            .arg(folder.path())
            .stdin(Stdio::null())
            .status()?;
        if !status.success() {
            return Err(format!("{job} failed").into());
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Runs one job, and describes it.
fn run_job(job: &str, folder: &FilePath) -> Result<String> {
    let read = |name: &str| -> Result<JointLog> {
        let log = JointLog::read(File::open(folder.join(name))?)?;
        match log.losses.first() {
            Some(loss) => Err(format!("{} losses, the first: {loss}", log.losses.len()).into()),
            None => Ok(log),
        }
    };
    Ok(match job {
        "--read" | "--read-csv" => {
            let log = read(if job == "--read" { MCAP } else { CSV })?;
            format!("{job}, {} samples", log.t_s.len())
        }
        "--compare" => {
            let plan = PlannedTrajectory::read_mcap(File::open(folder.join(PLAN))?, None)?;
            let comparison = compare(&plan, &read(MCAP)?)?;
            format!(
                "{job}, {} motions, off by {:.1e} s and, with its noise, {:.3} mm",
                comparison.motions.len(),
                comparison.cycle_time.error_s,
                1e3 * comparison.flange_m.max
            )
        }
        _ => {
            let program = Program::from_json(&fs::read_to_string(folder.join(PROGRAM))?)?;
            let recording = RecordedRun { program: &program, log: &read(MCAP)? };
            let identified = identify(&[recording], &Robot::default())?;
            format!("{job}, {} blends", identified.blends.len())
        }
    })
}

/// Writes a program, its plan and a recording of it, with a pause before and after.
fn write(minutes: usize, folder: &FilePath) -> Result<()> {
    let create = |name: &str| File::create(folder.join(name));
    let robot = Robot::default();
    let text = long_program::text(Kind::Stops, minutes * MOTIONS_A_MINUTE);
    fs::write(folder.join(PROGRAM), &text)?;
    let plan = PlanRequest::default().plan(&ProgramSource::from_json(&text)?)?;
    let trajectory = &plan.trajectory;
    write_plan(BufWriter::new(create(PLAN)?), &plan, PlanConfig::default(), &text)?;

    // Fewer periods make writing faster, and do not affect reading.
    let config = RecorderConfig { period: Duration::from_secs(10), ..RecorderConfig::default() };
    let mut random = fastrand::Rng::with_seed(1);
    let mut recorder = Recorder::new(create(MCAP)?, &robot, config)?;
    for k in 0.. {
        let t = Duration::from_secs(1) / RATE_HZ * k;
        if t.as_secs_f64() > trajectory.cycle_time_s() + 4.0 {
            break;
        }
        let q = trajectory.at(t.as_secs_f64() - 2.0).q;
        recorder.sample(t, &q.map(|q| q + NOISE_RAD * random.f64_normal(0.0, 1.0)))?;
    }
    recorder.finish(&BTreeMap::new(), &[])?;
    JointLog::read(File::open(folder.join(MCAP))?)?.write_csv(BufWriter::new(create(CSV)?))?;
    for name in [PLAN, MCAP, CSV] {
        println!("{name}: {:.0} MB", fs::metadata(folder.join(name))?.len() as f64 / 1e6);
    }
    Ok(())
}
