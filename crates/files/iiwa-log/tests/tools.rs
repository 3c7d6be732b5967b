//! Plans of programs with a tool: TCP pose and flange pose.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::io::Cursor;

use iiwa_log::{PlanConfig, PlanRecord, PlanSize, PlanWriter, Recording, write_plan};
use iiwa_plan::{PlanFigures, PlanOptions, PlanRequest, ProgramSource};
use iiwa_traj::Trajectory;

const TEXT: &str = include_str!("../../../../fixtures/pick-and-place.json");

fn planned(text: &str) -> (Trajectory, Vec<u8>) {
    let plan = PlanRequest::default().plan(&ProgramSource::from_json(text).unwrap()).unwrap();
    let file = write_plan(Cursor::new(Vec::new()), &plan, PlanConfig::default(), text)
        .unwrap()
        .into_inner();
    (plan.trajectory, file)
}

#[test]
fn poses_are_of_the_tcp_that_moves_and_of_the_flange() {
    let (plan, file) = planned(TEXT);
    let recording = Recording::from_bytes(&file).unwrap();
    let samples = recording.joint_states.len();
    assert_eq!((recording.tcp_poses.len(), recording.flange_poses.len()), (samples, samples));
    let robot = plan.path().robot();
    let mut tips = 0;
    let poses = std::iter::zip(&recording.tcp_poses, &recording.flange_poses);
    for (state, (tcp, flange)) in std::iter::zip(&recording.joint_states, poses) {
        assert_eq!((tcp.t_s, flange.t_s), (state.t_s, state.t_s));
        assert_eq!((&*tcp.frame_id, &*flange.frame_id), ("iiwa_link_0", "iiwa_link_0"));
        let pose = robot.flange_pose(&state.q);
        assert_eq!(flange.position_m, pose.position_m);
        assert_eq!(flange.rotation_xyzw, pose.quaternion_xyzw());
        // One of the two TCPs belongs to the program, the other to its seventh motion.
        let motion = plan.at(state.t_s).motion;
        let offset_m = if motion.number() == 7 { [0.0, 0.04, 0.12] } else { [0.0, 0.0, 0.12] };
        tips += usize::from(motion.number() == 7);
        let [x, y, z] = tcp.position_m;
        let expected: [f64; 3] = std::array::from_fn(|i| {
            let along = (0..3).map(|k| pose.rotation[i][k] * offset_m[k]).sum::<f64>();
            pose.position_m[i] + along
        });
        let off = (0..3).map(|i| ([x, y, z][i] - expected[i]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-9, "{}: {off}", state.t_s);
    }
    assert!(tips > 50 && tips < samples / 2);
}

#[test]
fn a_program_without_a_tool_has_no_topic_of_the_flange() {
    let (_, file) = planned(include_str!("../../../../fixtures/ten-motions.json"));
    let recording = Recording::from_bytes(&file).unwrap();
    assert!(recording.flange_poses.is_empty() && !recording.tcp_poses.is_empty());
    let topic = b"/flange_pose";
    assert!(!file.windows(topic.len()).any(|bytes| bytes == topic));
}

#[test]
fn figures_of_the_tcp_read_back() {
    let (plan, file) = planned(TEXT);
    let figures = PlanFigures::of(&plan, &PlanOptions::default());
    let record = PlanRecord::read(&*file).unwrap();
    assert_eq!(record.figures().as_ref(), Some(&figures));
    let json = record.to_json();
    let keys = ["tcp_speed_peak_mm_s", "singularity", "status", "e1_deg"];
    for (index, motion) in json["motions"].as_array().unwrap().iter().enumerate() {
        // All motions except a wait: the program has a tool.
        let has = index != 2;
        assert!(keys.iter().all(|key| motion.get(key).is_some() == has), "{motion}");
    }
    let circ = &json["motions"][5];
    assert_eq!((&circ["type"], &circ["status"]), (&"circ".into(), &2.into()));
    assert!((circ["tcp_speed_peak_mm_s"].as_f64().unwrap() - 300.0).abs() < 0.01);
    assert_eq!(circ["singularity"]["axis"], "shoulder");
    let kinds: Vec<_> = record.pieces.iter().map(|piece| piece.kind.name()).collect();
    assert!(kinds.contains(&"lin") && kinds.contains(&"circ") && kinds.contains(&"blend"));
}

#[test]
fn files_with_a_tool_are_as_large_as_estimated() {
    for text in
        [TEXT.to_owned(), TEXT.replace("\"cart_velocity_mm_s\": 250", "\"velocity_rel\": 0.02")]
    {
        let (plan, _) = planned(&text);
        for rate_hz in [50.0, 250.0, 1000.0] {
            let config = iiwa_log::PlanConfig { rate_hz, ..iiwa_log::PlanConfig::default() };
            let mut writer =
                PlanWriter::new(Cursor::new(Vec::new()), plan.path().robot(), config).unwrap();
            plan.sections().iter().for_each(|section| writer.section(section).unwrap());
            let figures = PlanFigures::new(iiwa_traj::Timing::default(), plan.path().robot(), 0);
            let bytes = writer.finish(&figures, None).unwrap().into_inner().len();
            let ratio = PlanSize::of(&plan, rate_hz).bytes() as f64 / bytes as f64;
            println!("{rate_hz} Hz: {bytes}, {ratio}");
            assert!((1.0 / 1.25..1.25).contains(&ratio), "{rate_hz} Hz: {ratio}, {bytes}");
        }
    }
}
