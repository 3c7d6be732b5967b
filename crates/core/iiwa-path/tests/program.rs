//! Programs: their JSON form and its meaning.

// Numbers are compared to the last bit on purpose; test helpers may panic.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use std::f64::consts::PI;

use iiwa_kin::{Joints, Robot};
use iiwa_path::{JointPath, Step};
use iiwa_program::{
    Blend, Fault, Motion, MotionIndex, MotionList, Program, Ptp, Sources, Start, Workcell,
};
use proptest::prelude::*;

use crate::any_program::any_program;

fn read(motions: &str) -> Program {
    Program::from_json(&format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
            "motions": [{motions}] }}"#
    ))
    .unwrap()
}

fn path(program: &Program) -> JointPath {
    JointPath::new(program, &Robot::lbr_iiwa_7_r800()).unwrap()
}

/// Two motions at a right angle, with `blend` between them.
fn corner(blend: Option<Blend>) -> JointPath {
    let first = Ptp { blend, ..Ptp::to([0.8, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]) };
    let second = Ptp::to([0.8, 0.6, 0.0, 0.0, 0.0, 0.0, 0.0]);
    path(&Program {
        robot: None,
        start: Start::Joints([0.0; 7]),
        motions: vec![Motion::Ptp(first), Motion::Ptp(second)],
        workcell: Workcell::default(),
        sources: Sources::default(),
    })
}

fn reach(path: &JointPath) -> f64 {
    path.blends().next().unwrap().1.tangent_lengths_rad()[0]
}

/// Formats steps with all their numbers for comparison, because segments of any shape cannot be
/// compared.
fn shown(steps: &[Step]) -> Vec<String> {
    steps.iter().map(|step| format!("{step:?}")).collect()
}

proptest! {
    #[test]
    fn json_reads_back_as_it_was(program in any_program()) {
        let json = program.to_json();
        prop_assert_eq!(Program::from_json(&json).unwrap(), program);
    }
}

#[test]
fn degrees_and_radians_are_the_same_joints() {
    let program = read(
        r#"{ "type": "ptp", "joints_deg": [90, -45, 30, 60, 180, 0, 1] },
           { "type": "ptp", "joints_rad": [1, 2, 3, -1, -2, -3, 0.5] }"#,
    );
    let [Motion::Ptp(deg), Motion::Ptp(rad)] = program.motions.as_slice() else {
        panic!("two motions")
    };
    let expected = [PI / 2.0, -PI / 4.0, PI / 6.0, PI / 3.0, PI, 0.0, PI / 180.0];
    for (actual, expected) in deg.target_rad.iter().zip(expected) {
        assert!((actual - expected).abs() < 1e-15);
    }
    assert_eq!(rad.target_rad, [1.0, 2.0, 3.0, -1.0, -2.0, -3.0, 0.5]);
}

#[test]
fn defaults_are_full_speed_and_no_blend() {
    let program = read(r#"{ "type": "ptp", "joints_rad": [1, 1, 1, 1, 1, 1, 1] }"#);
    assert_eq!(program.motions, [Motion::Ptp(Ptp::to([1.0; 7]))]);
    assert_eq!(program.robot, None);
}

#[test]
fn shares_for_all_joints_or_one_each() {
    let program = read(
        r#"{ "type": "ptp", "joints_rad": [1, 1, 1, 1, 1, 1, 1], "velocity_rel": 0.5,
             "acceleration_rel": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], "jerk_rel": 1 }"#,
    );
    let path = path(&program);
    let (limits, robot) = (&path.limits()[0], path.robot().limits());
    for j in 0..7 {
        assert_eq!(limits.velocity_rad_s()[j], 0.5 * robot.velocity_rad_s[j]);
        let share = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7][j];
        assert_eq!(limits.acceleration_rad_s2()[j], share * robot.acceleration_rad_s2[j]);
        assert_eq!(limits.jerk_rad_s3()[j], robot.jerk_rad_s3[j]);
    }
    assert!(program.to_json().contains("0.7"));
    assert_eq!(Program::from_json(&program.to_json()).unwrap(), program);
}

#[test]
fn a_fraction_is_of_the_shorter_neighbour() {
    for fraction in [0.01, 0.25, 0.5] {
        let path = corner(Some(Blend::Fraction(fraction)));
        assert!((reach(&path) - 0.6 * fraction).abs() < 1e-15);
    }
}

/// `sunrise_rel` 1 is half of a motion.
#[test]
fn sunrise_rel_is_twice_the_fraction() {
    for x in [0.05, 0.3, 1.0] {
        let sunrise = corner(Some(Blend::SunriseRel(x)));
        let fraction = corner(Some(Blend::Fraction(0.5 * x)));
        assert_eq!(shown(sunrise.steps()), shown(fraction.steps()));
    }
}

#[test]
fn small_blends_are_stops() {
    let stop = corner(None);
    let settles = stop.steps().iter().filter(|step| matches!(step, Step::Settle { .. })).count();
    assert_eq!(settles, 2);
    for blend in [
        Blend::SunriseRel(0.049_999),
        Blend::SunriseRel(0.0),
        Blend::CartMm(3.999),
        Blend::CartMm(0.0),
        Blend::Fraction(0.0),
    ] {
        let path = corner(Some(blend));
        assert_eq!(shown(path.steps()), shown(stop.steps()), "{blend:?}");
    }
    for blend in [Blend::SunriseRel(0.05), Blend::CartMm(4.0), Blend::Fraction(1e-6)] {
        let path = corner(Some(blend));
        assert_eq!(path.blends().count(), 1, "{blend:?}");
        let settles = path.steps().iter().filter(|step| matches!(step, Step::Settle { .. }));
        assert_eq!(settles.count(), 1, "{blend:?}");
    }
}

/// A blend requires motion on both sides of a corner: otherwise the robot stops.
#[test]
fn a_repeated_target_only_settles() {
    let (a, b) = ([0.5; 7], [0.2; 7]);
    let blend = Blend::Fraction(0.25);
    let go = |to: Joints| Ptp::to(to);
    for (first, second) in [
        (go(a), go(a)),
        (go(a).blend(blend), go(a)),
        (go(a), go(a).blend(blend)),
        (go(a).blend(blend), go(a).blend(blend)),
    ] {
        let motions = vec![Motion::Ptp(first), Motion::Ptp(second), Motion::Ptp(go(b))];
        let path = path(&Program {
            robot: None,
            start: Start::Joints([0.0; 7]),
            motions,
            workcell: Workcell::default(),
            sources: Sources::default(),
        });
        assert_eq!(path.blends().count(), 0);
        let kinds: Vec<_> = path
            .steps()
            .iter()
            .map(|step| match step {
                Step::Move { motion, .. } => ("move", motion.index()),
                Step::Settle { motion, .. } => ("settle", motion.index()),
                _ => panic!("{step:?}"),
            })
            .collect();
        assert_eq!(kinds, [("move", 0), ("settle", 0), ("settle", 1), ("move", 2), ("settle", 2)]);
    }
}

#[test]
fn a_wait_follows_settling() {
    let program = read(
        r#"{ "type": "wait", "seconds": 1 },
           { "type": "ptp", "joints_rad": [1, 0, 0, 0, 0, 0, 0] },
           { "type": "wait", "seconds": 0 }, { "type": "wait", "seconds": 2.5 }"#,
    );
    let path = path(&program);
    let steps = path.steps();
    assert_eq!(
        shown(&steps[..1]),
        shown(&[Step::Wait { motion: MotionIndex::new(0), seconds: 1.0 }])
    );
    assert!(
        matches!(steps[1], Step::Move { motion, blend: None, .. } if motion == MotionIndex::new(1))
    );
    assert_eq!(
        shown(&steps[2..]),
        shown(&[
            Step::Settle { motion: MotionIndex::new(1), blocking: false, still: false },
            Step::Wait { motion: MotionIndex::new(2), seconds: 0.0 },
            Step::Wait { motion: MotionIndex::new(3), seconds: 2.5 }
        ])
    );
}

/// A change of payload is a wait of zero duration, with another payload afterwards.
#[test]
fn a_change_of_the_load_takes_no_time() {
    let motions = |between: &str| {
        format!(
            r#"{{ "type": "ptp", "joints_rad": [1, 0, 0, 0, 0, 0, 0] }}, {between},
               {{ "type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0] }}"#
        )
    };
    let waits = path(&read(&motions(r#"{ "type": "wait", "seconds": 0 }"#)));
    let picks = r#"{ "type": "load", "load": { "mass_kg": 2, "center_mm": [0, 0, 50] } }"#;
    let picks = path(&read(&motions(picks)));
    assert_eq!(shown(picks.steps()), shown(waits.steps()));
    let masses = [0, 1, 2].map(|i| picks.load(MotionIndex::new(i)).map(|load| load.mass_kg));
    assert_eq!(masses, [None, Some(2.0), Some(2.0)]);
    assert_eq!(waits.load(MotionIndex::new(2)), None);
    let torques_of = |motion| {
        picks
            .dynamics(MotionIndex::new(motion))
            .gravity_torques(&[0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])[1]
    };
    let lever_m = (0.8 + 0.152 + 0.05) * 1.0_f64.sin();
    assert!((torques_of(2) - torques_of(0) + 2.0 * 9.81 * lever_m).abs() < 1e-9);
}

#[test]
fn a_list_of_motions_round_trips() {
    let text = r#"{ "type": "anything", "motions": [
        { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0], "blend": { "fraction": 0.25 } },
        { "type": "ptp", "joints_rad": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], "velocity_rel": 0.5 },
        { "type": "wait", "seconds": 0.5 }
    ] }"#;
    let list = MotionList::from_json(text).unwrap();
    assert_eq!(list.motions.len(), 3);
    let again = serde_json::json!({ "motions": list.motions }).to_string();
    assert_eq!(MotionList::from_json(&again).unwrap(), list);

    let wrong =
        r#"{ "motions": [{ "type": "wait", "seconds": 1 }, { "type": "wait", "seconds": -1 }] }"#;
    let error = MotionList::from_json(wrong).unwrap_err();
    assert_eq!(
        error.to_string(),
        "motion 2: a wait of -1 s; it must be from 0 to 86400 s, at line 1, column 78"
    );
    let error = MotionList::from_json("{}").unwrap_err();
    assert!(error.to_string().contains("`motions`"), "{error}");
}

/// A blend that overshoots its targets leaves the range of joint 2 at either end by the same
/// amount.
#[test]
fn blends_beyond_either_end_of_the_range_are_refused() {
    let outside = |sign: f64, at_deg: f64| {
        let pose = |deg: [f64; 2]| [sign * deg[0], sign * deg[1], 0.0, 0.0, 0.0, 0.0, 0.0];
        let program = Program::from_deg(pose([0.0, at_deg]))
            .ptp_deg(pose([60.0, at_deg]))
            .blend(Blend::Fraction(0.5))
            .ptp_deg(pose([120.0, 100.0]))
            .build();
        match JointPath::new(&program, &Robot::lbr_iiwa_7_r800()) {
            Ok(_) => None,
            Err(Fault::BlendOutside { outside, .. }) => Some(outside.found_rad.to_degrees()),
            Err(fault) => unreachable!("{fault}"),
        }
    };
    let [upper, lower] = [1.0, -1.0].map(|sign| outside(sign, 120.0).unwrap());
    assert!(upper > 120.001 && (upper + lower).abs() < 1e-9, "{upper} {lower}");
    assert_eq!([1.0, -1.0].map(|sign| outside(sign, 119.0)), [None; 2]);
}

#[test]
fn torque_limits_are_a_share_of_the_robot_s() {
    let limits = |key: &str| {
        let text = format!(
            r#"{{ "version": 1, {key} "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
                "motions": [{{ "type": "ptp", "joints_deg": [9, 30, 0, -60, 0, 90, 0] }}] }}"#
        );
        path(&Program::from_json(&text).unwrap()).torque_limits_nm()
    };
    assert_eq!(limits(""), None);
    let expected = Robot::lbr_iiwa_7_r800().limits().torque_nm.map(|limit| 0.4 * limit);
    assert_eq!(limits(r#""limit_torque_percent": 40,"#), Some(expected));
}
