//! Writes a synthetic recording: `sample FILE.mcap [FIGURES.json]`.
//!
//! The arm oscillates for 10 s at 250 Hz. The recording has all types of content, for testing
//! programs that read recordings; the example prints the time needed for writing.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs::{self, File};
use std::io::{Cursor, Seek, Write};
use std::time::{Duration, Instant};

use iiwa_log::{
    Config, FramePose, MotionEntry, TrajectoryMessage, TrajectoryPoint, WriteError, Writer,
};

const TICK: Duration = Duration::from_millis(4);
const TICKS: u32 = 2500;

const URDF: &str = r#"<robot name="iiwa"><link name="iiwa_link_0">
    <visual><geometry><cylinder radius="0.1" length="0.3"/></geometry></visual>
</link></robot>"#;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let file = arguments.next().ok_or("usage: sample FILE.mcap [FIGURES.json]")?;

    // The best of several runs, into memory: disk and first memory access are not measured.
    let mut best = Duration::MAX;
    let mut bytes = Vec::new();
    for _ in 0..10 {
        bytes.clear();
        let begin = Instant::now();
        bytes = write(Cursor::new(std::mem::take(&mut bytes)))?.into_inner();
        best = best.min(begin.elapsed());
    }
    let per_sample = best / TICKS;
    let mut err = std::io::stderr();
    writeln!(err, "{TICKS} samples in {best:?}, {per_sample:?} each; {} bytes", bytes.len())?;

    write(File::create(file)?)?.sync_all()?;
    if let Some(file) = arguments.next() {
        fs::write(file, serde_json::to_vec(&figures())?)?;
    }
    Ok(())
}

/// Returns the figures of the run, as a planning program prints them.
fn figures() -> serde_json::Value {
    serde_json::json!({
        "cycle_time_s": (TICK * TICKS).as_secs_f64(),
        "motion_time_s": 9.95,
        "settle_time_s": 0.05,
        "wait_time_s": 0,
        "timing": "acceleration",
        "robot": "lbr_iiwa_7_r800",
        "samples": 100,
        "motions": [
            { "index": 1, "type": "ptp", "start_s": 0.0,
              "limited_by": { "joint": 2, "kind": "velocity" } }
        ],
        "output": null
    })
}

/// Returns one entry per key: texts unchanged, all other values as JSON.
fn metadata() -> BTreeMap<String, String> {
    let figures = figures();
    let entries = figures.as_object().into_iter().flatten().map(|(key, value)| {
        (key.clone(), value.as_str().map_or_else(|| value.to_string(), str::to_owned))
    });
    entries.collect()
}

fn write<W: Write + Seek>(stream: W) -> Result<W, WriteError> {
    let names: Vec<String> = (0..=8).map(|i| format!("iiwa_link_{i}")).collect();
    let mut writer = Writer::new(stream, Config::default())?;
    writer.robot_description(Duration::ZERO, URDF)?;

    let mut trajectory = TrajectoryMessage::new()?;
    for i in 0..=1700_u32 {
        let time_from_start = TICK * TICKS * i / 1700;
        let (positions, velocities) = state(time_from_start.as_secs_f64());
        let accelerations = positions.map(|q| -q);
        trajectory.push(&TrajectoryPoint {
            time_from_start,
            positions,
            velocities,
            accelerations,
        })?;
    }
    writer.joint_trajectory(Duration::ZERO, trajectory)?;

    for tick in 0..=TICKS {
        let t = TICK * tick;
        if tick % 500 == 0 && tick < TICKS {
            let motion = MotionEntry {
                index: tick / 500 + 1,
                kind: "line".into(),
                limiting_joint: Some(2),
                limiting_kind: "velocity".into(),
                name: None,
                group: None,
            };
            writer.motion(t, &motion)?;
        }
        let (q, dq) = state(t.as_secs_f64());
        writer.joint_state(t, &q, &dq, None)?;
        let frames: [FramePose<'_>; 9] = std::array::from_fn(|i| {
            let angle = if (1..=7).contains(&i) { q[i - 1] } else { 0.0 };
            FramePose {
                parent: if i == 0 { "world" } else { &names[i - 1] },
                child: &names[i],
                translation_m: [0.0, 0.0, 0.2],
                rotation_xyzw: turn(i, angle),
            }
        });
        writer.transforms(t, &frames)?;
        let place = [0.5 * q[0].cos(), 0.5 * q[0].sin(), 0.6 + 0.1 * q[1]];
        writer.tcp_pose(t, "iiwa_link_0", place, turn(0, q[0]))?;
    }
    writer.attach("program.json", "application/json", br#"{"version": 1}"#)?;
    writer.attach("robot.urdf", "application/xml", URDF.as_bytes())?;
    writer.metadata("iiwasim", &metadata())?;
    writer.finish()
}

/// Returns a rotation by `angle`, with alternating axes.
fn turn(i: usize, angle: f64) -> [f64; 4] {
    let (sin, cos) = (angle / 2.0).sin_cos();
    if i.is_multiple_of(2) { [0.0, 0.0, sin, cos] } else { [0.0, sin, 0.0, cos] }
}

fn state(t_s: f64) -> ([f64; 7], [f64; 7]) {
    let joint = |i: usize| (0.3 + 0.1 * i as f64) * t_s;
    (
        std::array::from_fn(|i| joint(i).sin()),
        std::array::from_fn(|i| (0.3 + 0.1 * i as f64) * joint(i).cos()),
    )
}
