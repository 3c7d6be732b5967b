//! Plans random programs with jerk-limited timing and counts what goes wrong: programs without a
//! solution, and limits that are exceeded, by differences of the samples at 1 kHz and 250 Hz.
//!
//! `stress [PROGRAMS [SEED]]`, 100 000 programs by default. Exits with 1 if anything went wrong.
#![expect(clippy::print_stdout, reason = "a report is what it is for")]

use std::{collections::BTreeMap, env, fmt, process::ExitCode, time::Instant};

use iiwa_kin::Robot;
use iiwa_path::{JointPath, Program};
use iiwa_traj::{Timing, Trajectory};
use iiwasim_benches::{Result, machine};
use iiwasim_tests::{differences::ratios, random::programs};
use proptest::{
    strategy::{Strategy, ValueTree},
    test_runner::{Config, RngAlgorithm, TestRng, TestRunner},
};

/// Ratios that are allowed for velocity, acceleration and jerk.
const ALLOWED: [f64; 3] = [1.01, 1.01, 1.05];

fn main() -> Result<ExitCode> {
    let mut arguments = env::args().skip(1);
    let count: u64 = arguments.next().map_or(Ok(100_000), |text| text.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(1), |text| text.parse())?;
    println!("On {}, {}.", machine::processor(), machine::instruction_level());
    let mut tally = Tally::default();
    let start = Instant::now();
    for index in 0..count {
        let program = random(seed, index)?;
        tally.add(index, &program);
        if (index + 1) % 1000 == 0 {
            println!("{} programs, {:.0} s: {tally}", index + 1, start.elapsed().as_secs_f64());
        }
    }
    println!("{count} programs, {:.0} s: {tally}", start.elapsed().as_secs_f64());
    Ok(if tally.failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The random program with this number.
fn random(seed: u64, index: u64) -> Result<Program> {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    bytes[8..16].copy_from_slice(&index.to_le_bytes());
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    Ok(programs(12).new_tree(&mut runner).map_err(|reason| reason.to_string())?.current())
}

#[derive(Debug, Default)]
struct Tally {
    motions: usize,
    worst: [[f64; 3]; 2],
    /// The programs that failed, by what went wrong.
    failures: BTreeMap<String, Vec<u64>>,
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [fast, slow] =
            self.worst.map(|worst| worst.map(|ratio| format!("{ratio:.4}")).join(", "));
        write!(f, "{} motions; worst at 1 kHz {fast}, at 250 Hz {slow}", self.motions)?;
        for (what, programs) in &self.failures {
            let some = &programs[..programs.len().min(8)];
            write!(f, "\n  {}: {what}, as {some:?}", programs.len())?;
        }
        Ok(())
    }
}

impl Tally {
    fn add(&mut self, index: u64, program: &Program) {
        self.motions += program.motions.len();
        let mut fail = |what: String| self.failures.entry(what).or_default().push(index);
        let path = match JointPath::new(program, &Robot::default()) {
            Ok(path) => path,
            Err(fault) => return fail(fault.to_string()),
        };
        let trajectory = match Trajectory::plan(&path, Timing::default()) {
            Ok(trajectory) => trajectory,
            Err(error) => {
                let what = error.to_string();
                let what = what.split_once(": ").map_or(what.as_str(), |(_, what)| what);
                return fail(what.to_owned());
            }
        };
        for (rate_hz, worst) in [1000.0, 250.0].into_iter().zip(&mut self.worst) {
            let found = ratios(&trajectory, rate_hz);
            for i in 0..3 {
                worst[i] = worst[i].max(found[i]);
                // Not a number is too much, too.
                if found[i].is_nan() || found[i] > ALLOWED[i] {
                    let what = ["velocity", "acceleration", "jerk"][i];
                    self.failures.entry(what.to_owned()).or_default().push(index);
                }
            }
        }
    }
}
