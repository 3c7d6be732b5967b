//! Round trip of a plan: its figures, nodes, pieces, program and robot.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::io::Cursor;

use iiwa_kin::Robot;
use iiwa_log::{
    PlanConfig, PlanRecord, PlanRecordError, PlanWriter, RecordedRobotError, Recorder,
    RecorderConfig, Recording, write_plan,
};
use iiwa_plan::{ClearanceRecord, PlanOptions, PlanRequest, ProgramSource};
use iiwa_traj::{SweepOptions, Timing};

const TEXT: &str = include_str!("../../../../fixtures/waits-and-stops.json");

/// Returns a robot with the name of a built-in one and other limits.
fn slow() -> Robot {
    let mut limits = *Robot::default().limits();
    limits.velocity_rad_s = limits.velocity_rad_s.map(|v| 0.5 * v);
    Robot::default().with_limits(limits)
}

fn request(robot: &Robot, options: &PlanOptions) -> PlanRequest {
    PlanRequest { robot: Some(robot.clone()), options: *options, ..PlanRequest::default() }
}

fn file(robot: &Robot, options: &PlanOptions) -> Vec<u8> {
    let plan = request(robot, options).plan(&ProgramSource::from_json(TEXT).unwrap()).unwrap();
    write_plan(Cursor::new(Vec::new()), &plan, PlanConfig::default(), TEXT).unwrap().into_inner()
}

#[test]
fn everything_is_read_back() {
    let sweep = Timing::Acceleration(SweepOptions { samples: 50 });
    let sweep = PlanOptions { samples: 50, ..PlanOptions::with_timing(sweep) };
    for options in [PlanOptions::default(), sweep] {
        let source = ProgramSource::from_json(TEXT).unwrap();
        let mut planning = request(&slow(), &options).begin(&source).unwrap();
        let stream = Cursor::new(Vec::new());
        let mut writer = PlanWriter::new(stream, &slow(), PlanConfig::default()).unwrap();
        let (mut states, mut pieces, mut end) = (Vec::new(), Vec::new(), None);
        for section in planning.by_ref() {
            let section = section.unwrap();
            states.extend(section.states());
            end = Some(section.at(section.end_s()));
            pieces.extend(section.pieces().iter().filter(|piece| piece.duration_s > 0.0).cloned());
            writer.section(&section).unwrap();
        }
        for (distance_mm, link) in [(3.25, 4), (1.5, 6), (2.0, 7)] {
            let obstacle = "\"table\"".to_owned();
            let nearest = ClearanceRecord { distance_mm, link, obstacle, at_s: 0.5 };
            planning.figures_mut().add_clearance(nearest);
        }
        let figures = planning.figures();
        let file = writer.finish(figures, Some(TEXT)).unwrap().into_inner();
        let record = PlanRecord::read(&*file).unwrap();

        assert_eq!(record.figures().as_ref(), Some(figures));
        assert_eq!(record.figures().unwrap().clearance.unwrap().link, 6);
        assert_eq!(record.to_json(), serde_json::to_value(figures).unwrap());
        assert_eq!(record.timing(), Some(options.timing.name()));
        assert_eq!(record.robot().unwrap(), Some(slow()));
        assert_eq!(record.program.as_deref(), Some(TEXT));
        assert_eq!(record.pieces.len(), pieces.len());
        for (read, piece) in record.pieces.iter().zip(&pieces) {
            assert_eq!(
                (read.motion as usize, read.kind.name()),
                (piece.motion.number(), piece.kind.name())
            );
            assert!((read.start_s - piece.start_s).abs() < 1e-9);
            assert!((read.end_s - piece.end_s).abs() < 1e-8, "{read:?} {piece:?}");
        }
        states.extend(end);
        assert_eq!(record.nodes[0].q, states[0].q);
        for node in &record.nodes {
            let near = |t_s: f64| (t_s - node.t_s).abs() < 1e-9;
            assert!(states.iter().any(|state| near(state.t_s) && state.ddq == node.ddq));
        }
        let end_s = record.nodes.last().unwrap().t_s;
        assert!((end_s - figures.cycle_time_s).abs() < 1e-9);
    }
}

/// `/motion` has the name and the group of each motion that has them.
#[test]
fn pieces_have_names_and_groups() {
    let text = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }, "motions": [
        { "type": "ptp", "joints_deg": [20, 0, 0, 0, 0, 0, 0], "name": "approach" },
        { "type": "repeat", "count": 2, "group": "swings", "motions": [
            { "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
            { "type": "wait", "seconds": 0.1, "name": "pause" } ] } ] }"#;
    let plan = PlanRequest::default().plan(&ProgramSource::from_json(text).unwrap()).unwrap();
    let stream = Cursor::new(Vec::new());
    let file = write_plan(stream, &plan, PlanConfig::default(), text).unwrap().into_inner();
    let recording = Recording::from_bytes(&file).unwrap();
    let motions = recording.motions.iter().map(|sample| &sample.motion);
    let motions = motions.filter(|motion| motion.kind != "settle");
    let labels =
        motions.map(|motion| (motion.index, motion.name.as_deref(), motion.group.as_deref()));
    // In the second round, the arm is already there.
    let expected = [
        (1, Some("approach"), None),
        (2, None, Some("swings")),
        (3, Some("pause"), Some("swings")),
        (5, Some("pause"), Some("swings")),
    ];
    assert_eq!(labels.collect::<Vec<_>>(), expected);
}

#[test]
fn a_file_that_is_cut_off_is_no_plan_but_has_parts_of_one() {
    let whole = file(&Robot::default(), &PlanOptions::default());
    let all = PlanRecord::read(&*whole).unwrap();
    for percent in [30, 60, 90, 99] {
        let part = &whole[..whole.len() * percent / 100];
        let error = PlanRecord::read(part).unwrap_err();
        assert!(matches!(error, PlanRecordError::Read(_)), "{error}");
        let (record, end) = PlanRecord::read_part(part);
        assert!(end.is_some());
        for (read, piece) in record.pieces.iter().zip(&all.pieces) {
            assert_eq!((read.motion, read.start_s), (piece.motion, piece.start_s));
        }
        if record.nodes.is_empty() {
            assert!(matches!(record.check(), Err(PlanRecordError::Missing { .. })));
        }
    }
}

#[test]
fn a_recording_is_no_plan_and_knows_its_robot() {
    let recorder = |robot: &Robot| {
        let storage = Cursor::new(Vec::new());
        let mut recorder = Recorder::new(storage, robot, RecorderConfig::default()).unwrap();
        for ms in 0..100 {
            recorder.sample(std::time::Duration::from_millis(ms), &[0.0; 7]).unwrap();
        }
        recorder
    };
    let file = recorder(&slow()).finish(&[].into(), &[]).unwrap().into_inner();
    let error = PlanRecord::read(&*file).unwrap_err();
    assert!(matches!(error, PlanRecordError::Missing { part: "/joint_trajectory" }), "{error}");
    let (record, end) = PlanRecord::read_part(&*file);
    assert!(end.is_none() && record.figures().is_none());
    assert_eq!(record.robot().unwrap(), Some(slow()));
    let log = iiwa_log::JointLog::read(&*file).unwrap();
    assert_eq!(log.recorded_robot().unwrap(), Some(slow()));

    // A killed recorder has written its robot description, and no metadata.
    let mut recorder = recorder(&slow().with_name("slow robot"));
    recorder.flush().unwrap();
    let file = recorder.finish(&[].into(), &[]).unwrap().into_inner();
    let mut log = iiwa_log::JointLog::read(&*file).unwrap();
    assert_eq!(log.recorded_robot().unwrap().unwrap().name(), "slow robot");
    log.profile = None;
    assert_eq!(
        log.recorded_robot(),
        Err(RecordedRobotError::Unknown { name: "slow robot".to_owned() })
    );
    log.profile = Some("{}".to_owned());
    assert!(matches!(log.recorded_robot(), Err(RecordedRobotError::Profile { .. })));
    (log.profile, log.robot) = (None, None);
    assert_eq!(log.recorded_robot(), Ok(None));
}
