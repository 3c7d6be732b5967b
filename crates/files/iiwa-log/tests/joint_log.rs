//! Joint positions from files of every format: accepted and rejected content, and losses.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a failed test is a panic, and what is read back is what was written, bit by bit"
)]

mod formats;
mod losses;
#[cfg(feature = "parquet")]
mod parquet;
mod refusals;

use std::collections::BTreeMap;
use std::io::Cursor;
use std::time::Duration;

use iiwa_kin::{Joints, Robot};
use iiwa_log::{JointLog, JointLogError, Recorder, RecorderConfig};

const HEADER: &str =
    "t_s,joint_1_rad,joint_2_rad,joint_3_rad,joint_4_rad,joint_5_rad,joint_6_rad,joint_7_rad";
const DATA_RECORDER: &[u8] = include_bytes!("../../../../fixtures/data-recorder.log");

fn read(text: &str) -> Result<JointLog, JointLogError> {
    JointLog::read(text.as_bytes())
}

/// Returns the error text.
fn refused(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

/// Returns the joint positions of a test motion.
fn swing(t_s: f64) -> Joints {
    std::array::from_fn(|joint| 0.5 * ((joint + 1) as f64 * t_s).sin())
}

/// Returns a table of the test motion at these times, as `write_csv` writes it.
fn table(t_s: &[f64]) -> String {
    let log = JointLog::new(t_s.to_vec(), t_s.iter().map(|t_s| swing(*t_s)).collect());
    let mut bytes = Vec::new();
    log.write_csv(&mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

fn millis(count: u32) -> Vec<f64> {
    (0..count).map(|k| Duration::from_millis(k.into()).as_secs_f64()).collect()
}

/// Returns a recording of the test motion at 1 kHz, with a chunk every 100 ms.
fn recording(samples: u32, metadata: &[(&str, &str)]) -> Vec<u8> {
    let config = RecorderConfig { period: Duration::from_millis(100), ..RecorderConfig::default() };
    let robot = Robot::lbr_iiwa_14_r820();
    let mut recorder = Recorder::new(Cursor::new(Vec::new()), &robot, config).unwrap();
    for k in 0..samples {
        let t = Duration::from_millis(k.into());
        recorder.sample(t, &swing(t.as_secs_f64())).unwrap();
    }
    let metadata: BTreeMap<_, _> =
        metadata.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let program: (&str, &str, &[u8]) = ("program.json", "application/json", b"{\"version\": 1}");
    recorder.finish(&metadata, &[program]).unwrap().into_inner()
}
