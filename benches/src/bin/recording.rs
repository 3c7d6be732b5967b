//! Records joint positions at 1 kHz, and says how soon they are read and how much memory that takes:
//! from MCAP, then from CSV.
//!
//! `recording [MINUTES]`, 5 by default. An hour takes 2 GB in the folder for temporary files.
//!
//! Each reading has a process of its own, which reports the most memory that it ever held.
#![expect(clippy::print_stdout, reason = "figures are what it is for")]

use std::{
    collections::BTreeMap,
    env,
    fs::{self, File},
    io::BufWriter,
    path::Path,
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use iiwa_kin::{Joints, Robot};
use iiwa_log::{JointLog, Recorder, RecorderConfig};
use iiwasim_benches::{Result, machine};

const RATE_HZ: u32 = 1000;

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    if let [flag, file] = arguments.as_slice()
        && flag == "--read"
    {
        return read(Path::new(file));
    }
    let minutes: u32 = arguments.first().map_or(Ok(5), |text| text.parse())?;
    println!("On {}, {}.", machine::processor(), machine::instruction_level());
    let folder = tempfile::tempdir()?;
    let [mcap, csv] =
        ["mcap", "csv"].map(|kind| folder.path().join("recording").with_extension(kind));
    record(&mcap, minutes * 60 * RATE_HZ)?;
    JointLog::read(File::open(&mcap)?)?.write_csv(BufWriter::new(File::create(&csv)?))?;
    for file in [&mcap, &csv] {
        let status = Command::new(env::current_exe()?)
            .arg("--read")
            .arg(file)
            .stdin(Stdio::null())
            .status()?;
        if !status.success() {
            return Err(format!("reading {} failed", file.display()).into());
        }
    }
    Ok(())
}

/// Reads a file and reports.
fn read(file: &Path) -> Result<()> {
    let bytes = fs::metadata(file)?.len();
    let begin = Instant::now();
    let log = JointLog::read(File::open(file)?)?;
    let spent_s = begin.elapsed().as_secs_f64();
    let samples = log.t_s.len();
    println!(
        "{}: {samples} samples, {:.0} s of motion, {:.0} MB: read in {spent_s:.2} s, {:.0} ns a sample, \
         with {:.0} MB of memory",
        file.extension().unwrap_or_default().display(),
        log.duration_s(),
        bytes as f64 / 1e6,
        spent_s / samples as f64 * 1e9,
        machine::peak_memory_mb()?,
    );
    if !log.losses.is_empty() {
        return Err(format!("{} losses, the first: {}", log.losses.len(), log.losses[0]).into());
    }
    Ok(())
}

fn record(file: &Path, samples: u32) -> Result<()> {
    let robot = Robot::lbr_iiwa_7_r800();
    // The fewer periods, the sooner it is written; it makes no difference for what is read.
    let config = RecorderConfig { period: Duration::from_secs(10), ..RecorderConfig::default() };
    let mut recorder = Recorder::new(File::create(file)?, &robot, config)?;
    for k in 0..samples {
        recorder.sample(Duration::from_secs(1) / RATE_HZ * k, &joints(k))?;
    }
    recorder.finish(&BTreeMap::new(), &[])?;
    Ok(())
}

/// Swings with different periods, and noise as from an encoder on top, some 1e-5 rad.
fn joints(k: u32) -> Joints {
    let mut noise = k;
    std::array::from_fn(|joint| {
        let phase = (0.5 + 0.1 * joint as f64) * f64::from(k) * 1e-3;
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        0.8 * phase.sin() + 1e-7 * f64::from(noise >> 24)
    })
}
