//! Small recording with all types of content.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::time::Duration;

use iiwa_log::{Config, FramePose, MotionEntry, TrajectoryMessage, TrajectoryPoint, Writer};

pub(crate) const TICK: Duration = Duration::from_millis(4);
pub(crate) const JOINT_SAMPLES: u32 = 101;

pub(crate) fn state(t: Duration) -> ([f64; 7], [f64; 7]) {
    let t_s = t.as_secs_f64();
    (
        std::array::from_fn(|i| (t_s * (i + 1) as f64).sin()),
        std::array::from_fn(|i| (i + 1) as f64 * (t_s * (i + 1) as f64).cos()),
    )
}

pub(crate) fn point(i: u32) -> TrajectoryPoint {
    let time_from_start = Duration::from_millis(20) * i;
    let (positions, velocities) = state(time_from_start);
    let accelerations = positions.map(|q| -q);
    TrajectoryPoint { time_from_start, positions, velocities, accelerations }
}

pub(crate) fn sample() -> Vec<u8> {
    let mut writer = Writer::new(Cursor::new(Vec::new()), Config::default()).unwrap();
    writer.robot_description(Duration::ZERO, "<robot name=\"ä\"/>").unwrap();
    let trajectory = TrajectoryMessage::from_points((0..=20).map(point)).unwrap();
    writer.joint_trajectory(Duration::ZERO, trajectory).unwrap();
    for i in 0..JOINT_SAMPLES {
        let t = TICK * i;
        let piece = match i {
            0 => Some((1, "line", Some(4), "velocity")),
            50 => Some((2, "wait", None, "")),
            _ => None,
        };
        if let Some((index, kind, limiting_joint, limiting_kind)) = piece {
            let (kind, limiting_kind) = (kind.into(), limiting_kind.into());
            let (name, group) = (Some("swing".into()), (index == 1).then(|| "pick".into()));
            let motion = MotionEntry { index, kind, limiting_joint, limiting_kind, name, group };
            writer.motion(t, &motion).unwrap();
        }
        let (q, dq) = state(t);
        writer.joint_state(t, &q, &dq, None).unwrap();
        let frames = [("world", "iiwa_link_0"), ("iiwa_link_0", "iiwa_link_1")];
        let frames = frames.map(|(parent, child)| FramePose {
            parent,
            child,
            translation_m: [0.0, 0.0, 0.34],
            rotation_xyzw: [0.0, 0.0, 0.6, 0.8],
        });
        writer.transforms(t, &frames).unwrap();
        let place = [0.5, 0.0, f64::from(i)];
        writer.tcp_pose(t, "iiwa_link_0", place, [0.0, 0.0, 0.6, 0.8]).unwrap();
    }
    writer.attach("program.json", "application/json", b"{}").unwrap();
    writer.attach("empty", "text/plain", b"").unwrap();
    let figures = BTreeMap::from([("cycle_time_s".to_owned(), "0.4".to_owned())]);
    writer.metadata("iiwasim", &figures).unwrap();
    writer.finish().unwrap().into_inner()
}
