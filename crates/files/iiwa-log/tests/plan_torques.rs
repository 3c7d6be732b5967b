//! Torques in plan figures, plan files and tables.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::io::Cursor;

use iiwa_kin::{Joint, Robot};
use iiwa_log::{Config, JointLog, PlanConfig, PlanRecord, PlanTable, Recording, write_plan};
use iiwa_plan::{Plan, PlanFigures, PlanOptions, PlanRequest, ProgramSource};
use iiwa_traj::{SweepOptions, Timing};
use serde_json::Value;

/// Program that picks up a load at the start pose, and puts it down; ceiling-mounted robot.
const TEXT: &str = r#"{
    "version": 1,
    "mount": { "rpy_deg": [180, 0, 0] },
    "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    "motions": [
        { "type": "ptp", "joints_deg": [20, 50, 0, -60, 0, 70, 0], "blend": { "fraction": 0.3 } },
        { "type": "ptp", "joints_deg": [20, 70, 10, -40, 0, 70, 0] },
        { "type": "load", "load": { "mass_kg": 5, "center_mm": [0, 10, 60] } },
        { "type": "wait", "seconds": 0.1 },
        { "type": "ptp", "joints_deg": [60, 20, 0, -80, 30, 60, 0] },
        { "type": "load", "load": null },
        { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0], "velocity_rel": 0.3 }
    ]
}"#;

fn plan(text: &str, options: &PlanOptions) -> Plan {
    let request = PlanRequest { options: *options, ..PlanRequest::default() };
    request.plan(&ProgramSource::from_json(text).unwrap()).unwrap()
}

fn written(plan: &Plan, text: &str) -> Vec<u8> {
    let config = PlanConfig { rate_hz: 100.0, ..PlanConfig::default() };
    write_plan(Cursor::new(Vec::new()), plan, config, text).unwrap().into_inner()
}

fn timings() -> [PlanOptions; 2] {
    [Timing::default(), Timing::Acceleration(SweepOptions::default())].map(PlanOptions::with_timing)
}

#[test]
fn figures_are_those_of_the_trajectory() {
    for options in timings() {
        let plan = plan(TEXT, &options);
        let (figures, torques) = (plan.figures(), plan.trajectory.torques());
        assert_eq!(figures.motions.len(), torques.motions.len());
        for (record, of_motion) in figures.motions.iter().zip(&torques.motions) {
            let torque = record.torque.as_ref().unwrap();
            assert_eq!(record.index, of_motion.motion.number());
            assert_eq!(torque.peak_nm, of_motion.peak_nm);
            assert_eq!(torque.static_nm, of_motion.static_nm);
            assert_eq!(torque.peak_at_s, of_motion.peak_at_s);
            let limits = Robot::default().limits().torque_nm;
            for (j, limit_nm) in limits.iter().enumerate() {
                let percent = 100.0 * torque.peak_nm[j].abs() / limit_nm;
                assert!((torque.peak_percent[j] - percent).abs() < 1e-9);
            }
        }
        let (energy, power) = (figures.energy_j.as_ref().unwrap(), figures.power.as_ref().unwrap());
        for j in 0..7 {
            assert!((energy.positive[j] - torques.positive_work_j[j]).abs() < 1e-9);
            assert!((energy.negative[j] - torques.negative_work_j[j]).abs() < 1e-9);
        }
        assert_eq!((power.peak_w, power.at_s), (torques.peak_power_w, torques.peak_power_at_s));
        let largest = figures.largest_torque().unwrap();
        assert_eq!((largest.motion, largest.joint), (5, Joint::A2), "{largest}");
        let all = torques.motions.iter().flat_map(|motion| motion.peak_rel);
        assert_eq!(largest.percent, 100.0 * all.fold(0.0, f64::max));
    }
}

#[test]
fn files_have_the_torques_of_the_trajectory() {
    for options in timings() {
        let plan = plan(TEXT, &options);
        let file = written(&plan, TEXT);
        let states = Recording::from_bytes(&file).unwrap().joint_states;
        let log = JointLog::read(&*file).unwrap();
        let mut csv = PlanTable::csv(Vec::new(), 100.0).unwrap().exact();
        plan.trajectory.sections().iter().for_each(|section| csv.section(section).unwrap());
        let csv = String::from_utf8(csv.finish().unwrap()).unwrap();
        let mut rows = csv.lines();
        let head: Vec<&str> = rows.next().unwrap().split(',').collect();
        assert_eq!((head.len(), head[29], head[35]), (36, "torque_1_nm", "torque_7_nm"));
        let samples = plan.trajectory.samples(100.0).count();
        assert_eq!([states.len(), log.torques_nm.len(), rows.clone().count()], [samples; 3]);
        let exerted: Vec<_> = log.exerted_nm().collect();
        for (i, (state, row)) in plan.trajectory.samples(100.0).zip(rows).enumerate() {
            let torques = plan.trajectory.torques_of(&state).torque_nm;
            assert_eq!(states[i].torques_nm, Some(torques), "at {} s", state.t_s);
            assert_eq!(exerted[i], Some(torques));
            let row: Vec<f64> = row.split(',').map(|field| field.parse().unwrap()).collect();
            assert_eq!(row[29..], torques);
        }
        // The load acts from the pick-up to the put-down.
        let a2 = |t_s: f64| plan.trajectory.torques_at(t_s).torque_nm[1];
        let figures = plan.figures();
        let wait = figures.motions.iter().find(|motion| motion.r#type == "wait").unwrap();
        let (before, after) = (a2(wait.start_s - 0.01), a2(wait.start_s + 0.01));
        assert!(after.abs() > before.abs() + 20.0 && after > 0.0, "{before} {after}");
    }
}

#[test]
fn measured_torques_are_turned_to_the_sign_of_plans() {
    let mut log = JointLog::new(vec![0.0, 0.01], vec![[0.0; 7]; 2]);
    log.torques_nm = vec![None, Some([0.5; 7])];
    let bytes = log.to_mcap(Config::default(), &Robot::default(), TEXT).unwrap();
    let read = JointLog::read(&*bytes).unwrap();
    assert_eq!(read.torques_nm, [None, Some([0.5; 7])]);
    assert_eq!(read.exerted_nm().collect::<Vec<_>>(), [None, Some([-0.5; 7])]);
}

/// Tables contain the torques that joints exert, `DataRecorder` logs those that the controller
/// measures; without the torque of one joint, none are read.
#[test]
fn tables_have_torques() {
    let mut log = JointLog::new(vec![0.0, 0.01], vec![[0.1; 7]; 2]);
    log.torques_nm = vec![Some([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, -7.5]), Some([0.5; 7])];
    let mut csv = Vec::new();
    log.write_csv(&mut csv).unwrap();
    let text = String::from_utf8(csv.clone()).unwrap();
    assert!(text.starts_with("t_s,joint_1_rad") && text.contains(",torque_7_nm\n"), "{text}");
    assert!(text.contains(",-1.0,-2.0,-3.0,-4.0,-5.0,-6.0,7.5\n"), "{text}");
    assert_eq!(JointLog::read(&*csv).unwrap().torques_nm, log.torques_nm);
    let without = text.replace("torque_3_nm", "other");
    assert!(JointLog::read(without.as_bytes()).unwrap().torques_nm.is_empty());

    let names = |stem: &str| [0, 1, 2, 3, 4, 5, 6].map(|j| format!(" {stem}_LBR[{j}]")).concat();
    let recorded = format!(
        "ZeitInSec ZeitInNanoSec{}{}\n1 0 0 0 0 0 0 0 0 1 2 3 4 5 6 7\n",
        names("axisQMsr"),
        names("axisTauMsr")
    );
    let read = JointLog::read(recorded.as_bytes()).unwrap();
    assert_eq!(read.torques_nm, [Some([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])]);
}

#[test]
fn figures_of_earlier_versions_are_read() {
    let options = PlanOptions::default();
    let figures = plan(TEXT, &options).figures();
    let mut earlier = serde_json::to_value(&figures).unwrap();
    let object = earlier.as_object_mut().unwrap();
    for key in ["energy_j", "power"] {
        assert!(object.remove(key).is_some(), "{key}");
    }
    for motion in object["motions"].as_array_mut().unwrap() {
        motion.as_object_mut().unwrap().remove("torque").unwrap();
    }
    let read: PlanFigures = serde_json::from_value(earlier.clone()).unwrap();
    assert!(read.energy_j.is_none() && read.largest_torque().is_none());
    assert!(read.torque_warnings().is_empty());
    assert_eq!(serde_json::to_value(&read).unwrap(), earlier);
}

#[test]
fn figures_are_in_the_files() {
    let options = PlanOptions::default();
    let plan = plan(TEXT, &options);
    let record = PlanRecord::read(&*written(&plan, TEXT)).unwrap();
    assert_eq!(record.figures(), Some(plan.figures()));
    let json: Value = record.to_json();
    assert_eq!(json["motions"][0]["torque"]["peak_nm"].as_array().unwrap().len(), 7);
    assert_eq!(json["energy_j"]["negative"].as_array().unwrap().len(), 7);
}

/// Returns the figures of a plan with a load at the end of the outstretched arm: lifted, then held.
fn outstretched(mass_kg: f64) -> PlanFigures {
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 90, 0, 0, 0, 0, 0] }},
        "tools": {{ "weight": {{ "tcp": {{}},
            "load": {{ "mass_kg": {mass_kg}, "center_mm": [0, 0, 100] }} }} }},
        "tool": "weight", "motions": [
            {{ "type": "wait", "seconds": 0.1 }},
            {{ "type": "ptp", "joints_deg": [0, 60, 0, 0, 0, 0, 0] }} ] }}"#
    );
    let options = PlanOptions::default();
    plan(&text, &options).figures()
}

#[test]
fn overloaded_joints_are_reported() {
    assert!(outstretched(2.0).torque_warnings().is_empty());
    // 65 Nm for the arm, and a lever of 1.05 m for the load.
    let lifted = outstretched(9.0).torque_warnings();
    assert_eq!(lifted.len(), 1, "{lifted:?}");
    assert!(lifted[0].starts_with("motion 2: A2 needs 1"), "{lifted:?}");
    assert!(lifted[0].contains(" % of its torque (") && lifted[0].contains(" Nm of 176) at "));
    let warnings = outstretched(12.0).torque_warnings();
    assert_eq!(
        warnings[0],
        "motion 1: A2 cannot hold the arm and its payload at rest on this path: holding takes 189 \
         Nm of its 176"
    );
    assert!(warnings[1].starts_with("motion 2: A2 cannot hold"), "{warnings:?}");
}

#[test]
fn few_of_many_overloaded_motions_are_named() {
    let turns = (0..25).map(|i| {
        format!(r#"{{ "type": "ptp", "joints_deg": [{}, 90, 0, 0, 0, 0, 0] }}"#, 10 * (i % 2 + 1))
    });
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 90, 0, 0, 0, 0, 0] }},
        "tools": {{ "weight": {{ "tcp": {{}},
            "load": {{ "mass_kg": 13, "center_mm": [0, 0, 100] }} }} }},
        "tool": "weight", "motions": [{}] }}"#,
        turns.collect::<Vec<_>>().join(",")
    );
    let options = PlanOptions::default();
    let warnings = plan(&text, &options).figures().torque_warnings();
    assert_eq!(warnings.len(), 11);
    assert_eq!(warnings[10], "and 15 more motions need more torque than the joints have");
}
