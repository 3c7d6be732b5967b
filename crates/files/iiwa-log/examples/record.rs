//! Records a synthetic motion at 1 kHz, in real time and until it is killed: `record FILE.mcap
//! [PERIOD_MS]`. For testing programs that read recordings, and for tests that kill the recorder.
//!
//! `record FILE.mcap PERIOD_MS SECONDS RATE_HZ POSE_RATE_HZ` records as fast as possible, finishes
//! the file and prints its cost.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs::File;
use std::io::Write;
use std::time::{Duration, Instant};

use iiwa_kin::{Joints, Robot};
use iiwa_log::{Recorder, RecorderConfig};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or("usage: record FILE.mcap [PERIOD_MS ...]")?;
    let mut number = || arguments.next().map(|text| text.parse::<u32>()).transpose();
    let mut config = RecorderConfig::default();
    if let Some(period) = number()? {
        config.period = Duration::from_millis(period.into());
    }
    let (seconds, rate_hz) = (number()?, number()?.unwrap_or(1000));
    if let Some(rate_hz) = number()? {
        config.pose_rate_hz = rate_hz;
    }
    let storage = File::create(&file)?;
    let mut recorder = Recorder::new(storage, &Robot::lbr_iiwa_7_r800(), config)?;
    let tick = Duration::from_secs(1) / rate_hz;
    let begin = Instant::now();

    let Some(seconds) = seconds else {
        for k in 0.. {
            let t = tick * k;
            std::thread::sleep(t.saturating_sub(begin.elapsed()));
            recorder.sample(t, &joints(k))?;
        }
        return Ok(());
    };

    let samples = seconds * rate_hz;
    let mut slowest = Duration::ZERO;
    for k in 0..samples {
        let q = joints(k);
        let begin = Instant::now();
        recorder.sample(tick * k, &q)?;
        slowest = slowest.max(begin.elapsed());
    }
    let attachments: &[(&str, &str, &[u8])] = &[("program.json", "application/json", b"{}")];
    let file = recorder.finish(&BTreeMap::new(), attachments)?;
    let (spent, bytes) = (begin.elapsed(), file.metadata()?.len());
    let mut err = std::io::stderr();
    writeln!(
        err,
        "{samples} samples, {:?} each, {slowest:?} the slowest; {bytes} bytes, {:.1} MB an hour",
        spent / samples,
        bytes as f64 / f64::from(seconds) * 3600.0 / 1e6,
    )?;
    Ok(())
}

/// Returns oscillations with different periods, plus encoder noise of some 1e-5 rad.
fn joints(k: u32) -> Joints {
    let mut noise = k;
    std::array::from_fn(|joint| {
        let phase = (0.5 + 0.1 * joint as f64) * f64::from(k) * 1e-3;
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        0.8 * phase.sin() + 1e-7 * f64::from(noise >> 24)
    })
}
