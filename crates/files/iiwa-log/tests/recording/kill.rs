//! A killed recorder leaves a complete file.

use std::env;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use iiwa_kin::{Joints, Robot};
use iiwa_log::{Recorder, RecorderConfig};

use crate::recording::whole::both_ways;

/// Environment variables of the process to be killed: path of the recording, and period in ms.
const FILE: &str = "IIWA_LOG_TEST_FILE";
const PERIOD_MS: &str = "IIWA_LOG_TEST_PERIOD_MS";
const REAL_TIME: &str = "IIWA_LOG_TEST_REAL_TIME";

const TICK: Duration = Duration::from_millis(1);

fn joints(k: u32) -> Joints {
    std::array::from_fn(|joint| (f64::from(k) * 1e-3 + joint as f64).sin())
}

/// Records at 1 kHz and prints on standard output how many samples it has passed on.
#[test]
#[ignore = "the process that the other tests start, and kill"]
fn victim() {
    let Ok(file) = env::var(FILE) else { return };
    let period = Duration::from_millis(env::var(PERIOD_MS).unwrap().parse().unwrap());
    let real_time = env::var(REAL_TIME).is_ok();
    let config = RecorderConfig { period, ..RecorderConfig::default() };
    let robot = Robot::lbr_iiwa_7_r800();
    let mut recorder = Recorder::new(File::create(file).unwrap(), &robot, config).unwrap();
    let begin = Instant::now();
    let mut out = std::io::stdout().lock();
    for k in 0.. {
        if real_time {
            std::thread::sleep((TICK * k).saturating_sub(begin.elapsed()));
        }
        recorder.sample(TICK * k, &joints(k)).unwrap();
        writeln!(out, "\nsamples: {}", k + 1).unwrap();
    }
}

/// Kills a recorder `after` its first sample, and compares the file with the recorded samples.
fn kill(file: &Path, period_ms: u32, real_time: bool, after: Duration) {
    let mut command = Command::new(env::current_exe().unwrap());
    command
        .args(["recording::kill::victim", "--exact", "--ignored", "--nocapture"])
        .env(FILE, file)
        .env(PERIOD_MS, period_ms.to_string())
        .stdout(Stdio::piped());
    if real_time {
        command.env(REAL_TIME, "1");
    }
    let mut victim = command.spawn().unwrap();
    let mut reported = 0_usize;
    let mut begin = None;
    let mut killed = false;
    for line in BufReader::new(victim.stdout.take().unwrap()).lines() {
        if let Some(count) = line.unwrap().strip_prefix("samples: ").and_then(|n| n.parse().ok()) {
            reported = count;
            let begin = *begin.get_or_insert_with(Instant::now);
            if !killed && begin.elapsed() >= after {
                // SIGKILL on Unix.
                victim.kill().unwrap();
                killed = true;
            }
        }
    }
    assert!(!victim.wait().unwrap().success());
    assert!(killed && reported > 0);

    let (states, indexed) = both_ways(&fs::read(file).unwrap());
    for count in [states.len(), indexed] {
        // One more sample may be recorded but not yet reported.
        assert!(count <= reported + 1, "{count} of {reported}");
        assert!(count + period_ms as usize + 1 >= reported, "{count} of {reported}");
    }
    for (k, state) in (0..).zip(&states) {
        assert_eq!((state.t_s, state.q), ((TICK * k).as_secs_f64(), joints(k)));
    }
}

#[test]
fn in_real_time() {
    let folder = tempfile::tempdir().unwrap();
    for k in 0..6 {
        let after = Duration::from_micros(50_000 + 17_310 * k);
        kill(&folder.path().join("recording.mcap"), 20, true, after);
    }
}

#[test]
fn while_it_writes_most_of_the_time() {
    let folder = tempfile::tempdir().unwrap();
    for k in 0..20 {
        let after = Duration::from_micros(3_000 + 7_310 * k);
        kill(&folder.path().join("recording.mcap"), 4, false, after);
    }
}
