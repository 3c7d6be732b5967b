//! Changes that save time, and what they leave as it is.

use std::sync::{
    Arc, LazyLock,
    atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed},
};

use iiwa_kin::Robot;
use iiwa_optimise::{Advice, AdviceRow, Change, ChangeKind, Freedom, Optimiser};
use iiwa_plan::PlanOptions;
use iiwa_program::{Motion, MotionIndex, Program, Target, TargetRef};
use iiwa_traj::{Timing, Trajectory};

use crate::untouched::{assert_untouched, optimiser, pose};

/// Programs in joint space and with frames, lines, circles, tools and waits.
const PROGRAMS: [&str; 5] = [
    include_str!("../../../../fixtures/appendix-b.json"),
    include_str!("../../../../fixtures/ten-motions.json"),
    include_str!("../../../../fixtures/waits-and-stops.json"),
    include_str!("../../../../fixtures/pick-and-place.json"),
    include_str!("../../../../fixtures/sunrise/cell/expected.json"),
];

/// Advice for each of the programs; searched for once, since it takes seconds.
static ADVICE: LazyLock<Vec<(Program, Optimiser, Advice)>> = LazyLock::new(|| {
    let advise = |text: &&str| {
        let program = Program::from_json(text).unwrap();
        let optimiser = optimiser(&program);
        let advice = optimiser.advise(&program).unwrap();
        (program, optimiser, advice)
    };
    PROGRAMS.iter().map(advise).collect()
});

#[test]
fn each_row_is_confirmed_by_a_plan() {
    let mut rows = 0;
    for (program, optimiser, advice) in ADVICE.iter() {
        let mut all = program.clone();
        let mut all_s = advice.cycle_time_s;
        for row in &advice.rows {
            let alone = row.change.apply(program).unwrap();
            let alone_s = optimiser.plan(&alone).unwrap().cycle_time_s();
            let saved_s = advice.cycle_time_s - alone_s;
            assert!((saved_s - row.saved_s).abs() < 1e-6, "{}: {saved_s} {row:?}", row.change);
            assert!(row.saved_s >= 1e-3 && row.saved_on_top_s >= 1e-3, "{row:?}");
            all = row.change.apply(&all).unwrap();
            let with_all_s = optimiser.plan(&all).unwrap().cycle_time_s();
            assert!((all_s - with_all_s - row.saved_on_top_s).abs() < 1e-6, "{row:?}");
            all_s = with_all_s;
            rows += 1;
        }
        assert_eq!(all, advice.program);
        assert!((all_s - advice.changed_cycle_time_s).abs() < 1e-6);
        let falling = advice.rows.windows(2).all(|pair| pair[0].saved_s >= pair[1].saved_s);
        assert!(falling, "{:?}", advice.rows);
    }
    assert!(rows > 10, "{rows}");
}

/// The program of a Sunrise application, whose frames state their E1.
#[test]
fn a_palletising_program_becomes_faster() {
    let (_, _, advice) = &ADVICE[4];
    let share = 1.0 - advice.changed_cycle_time_s / advice.cycle_time_s;
    assert!(share > 0.14, "{share}");
    let is_elbow = |row: &AdviceRow| matches!(row.change.kind, ChangeKind::Elbow { .. });
    assert!(advice.rows.iter().any(is_elbow));
}

/// Frames, speeds of TCP paths, waits, inputs and outputs are those of the program.
#[test]
fn poses_and_process_speeds_stay() {
    for (program, _, advice) in ADVICE.iter() {
        assert_untouched(program, &advice.program);
    }
}

/// The base of a motion does not apply to a named frame; the base of the program does.
#[test]
fn another_elbow_angle_keeps_the_pose_of_a_named_frame() {
    for base in ["", r#""base": "cell","#] {
        let text = format!(
            r#"{{ "version": 1, {base}
                "bases": {{ "table": {{ "y_mm": 60 }}, "cell": {{ "y_mm": -40 }} }},
                "frames": {{ "q": {{ "x_mm": 500, "y_mm": 0, "z_mm": 400, "a_deg": 0, "b_deg": 180,
                                     "c_deg": 0, "e1_deg": 10, "status": 2, "turn": 2 }} }},
                "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
                "motions": [{{ "type": "ptp", "frame": "q", "base": "table" }}] }}"#
        );
        let program = Program::from_json(&text).unwrap();
        let motion = MotionIndex::new(0);
        let kind = ChangeKind::Elbow { from_rad: 0.0, to_rad: 0.4, last: motion };
        let changed = Change { motion, kind }.apply(&program).unwrap();
        let [Motion::Cartesian(old)] = &program.motions[..] else { panic!() };
        let [Motion::Cartesian(new)] = &changed.motions[..] else { panic!() };
        assert_ne!(old, new);
        assert_eq!(pose(&program, old), pose(&changed, new));
        // The signs of the joints may be others.
        let Some(TargetRef::Given(target)) = new.target() else { panic!() };
        assert_eq!(target.turn, None);
    }
}

/// E1 stays within 90 degrees of that of the program.
#[test]
fn elbow_angles_stay_in_their_range() {
    let kinds = ADVICE.iter().flat_map(|(_, _, advice)| &advice.rows).map(|row| &row.change.kind);
    for kind in kinds {
        if let ChangeKind::Elbow { from_rad, to_rad, .. } = kind {
            assert!((to_rad - from_rad).abs() <= 91.0_f64.to_radians(), "{kind:?}");
        }
    }
}

#[test]
fn a_rule_keeps_changes_away() {
    let program = Program::from_json(PROGRAMS[4]).unwrap();
    let optimiser = optimiser(&program);
    let advice = optimiser.advise_within(&program, &|_| false).unwrap();
    assert!(advice.rows.is_empty());
    assert_eq!(advice.program, program);
    assert_eq!(advice.changed_cycle_time_s, advice.cycle_time_s);
    let blends = optimiser.clone().with_max_blend_mm(0.0).advise(&program).unwrap();
    assert!(blends.rows.iter().all(|row| !matches!(row.change.kind, ChangeKind::Blend { .. })));
}

#[test]
fn waits_and_single_motions_have_nothing_to_change() {
    for program in [
        Program::from_deg([0.0; 7]).wait_s(1.0).build(),
        Program::from_deg([0.0; 7]).ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0]).build(),
    ] {
        let advice = optimiser(&program).advise(&program).unwrap();
        assert!(advice.rows.is_empty());
    }
}

/// A wait for a gripper that may as well close during the motion.
#[test]
fn waits_could_run_during_motions() {
    let program = Program::from_deg([0.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .ptp_deg([40.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .wait_s(0.3)
        .ptp_deg([0.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .build();
    let optimiser = optimiser(&program);
    let rows = optimiser.advise(&program).unwrap().rows;
    assert!(rows.iter().all(|row| !matches!(row.change.kind, ChangeKind::OverlapWait { .. })));
    let advice = optimiser.clone().with_freedom(Freedom::ALL).advise(&program).unwrap();
    let [row] = &advice.rows[..] else { panic!("{:?}", advice.rows) };
    assert_eq!(row.change.kind, ChangeKind::OverlapWait { seconds: 0.3, was_blocking: false });
    assert_eq!(row.change.motion.number(), 2);
    // The motion takes longer than the wait.
    assert!((0.25..0.301).contains(&row.saved_s), "{}", row.saved_s);
    let changed_s = optimiser.plan(&row.change.apply(&program).unwrap()).unwrap().cycle_time_s();
    assert!((advice.cycle_time_s - changed_s - row.saved_s).abs() < 1e-9);
}

/// A blend before the motion would lengthen the wait in Sunrise: neither of both changes is made
/// after the other.
#[test]
fn waits_and_blends_exclude_each_other() {
    let program = Program::from_deg([0.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .ptp_deg([40.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .ptp_deg([40.0, 50.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .wait_s(0.3)
        .ptp_deg([0.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .build();
    let [first, wait] = [0, 2].map(MotionIndex::new);
    let overlap = ChangeKind::OverlapWait { seconds: 0.3, was_blocking: false };
    let overlap = Change { motion: wait, kind: overlap };
    let blend = Change { motion: first, kind: ChangeKind::Blend { from: None, to_mm: 20.0 } };
    assert!(overlap.apply(&blend.apply(&program).unwrap()).is_none());
    assert!(blend.apply(&overlap.apply(&program).unwrap()).is_none());
    let advice = optimiser(&program).with_freedom(Freedom::ALL).advise(&program).unwrap();
    let is_overlap = |row: &AdviceRow| matches!(row.change.kind, ChangeKind::OverlapWait { .. });
    assert_eq!(advice.rows.iter().filter(|row| is_overlap(row)).count(), 1, "{:?}", advice.rows);
}

/// The standstill that a change removes is an assumption, and so is the whole of a plan with
/// another timing.
#[test]
fn assumptions_before_the_change_count() {
    let text = r#"{ "version": 1, "start": { "joints_deg": [0, 20, 0, -70, 0, 60, 0] }, "motions": [
        { "type": "ptp", "joints_deg": [90, 20, 0, -70, 0, 60, 0], "blocking": true },
        { "type": "ptp", "joints_deg": [0, 20, 0, -70, 0, 60, 0] }] }"#;
    let program = Program::from_json(text).unwrap();
    for timing in [Timing::default(), Timing::jerk_limited()] {
        let options = PlanOptions::with_timing(timing);
        let rows = Optimiser::new(Robot::default(), options).advise(&program).unwrap().rows;
        let row = rows.iter().find(|row| row.change.kind == ChangeKind::NoWaitForEnd);
        assert!(row.is_none_or(|row| !row.rests_on.is_empty()), "{rows:?}");
        assert!(rows.iter().all(|row| !row.rests_on.is_empty()) && !rows.is_empty(), "{rows:?}");
    }
}

/// Point-to-point motions with a plateau follow recordings, and blends rest on an assumption.
#[test]
fn rows_state_what_their_times_rest_on() {
    let program = Program::from_deg([0.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .ptp_deg([90.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .velocity(0.7)
        .ptp_deg([90.0, -70.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .build();
    let rows = optimiser(&program).advise(&program).unwrap().rows;
    for row in &rows {
        let blends = row.rests_on.iter().any(|text| text.contains("blends"));
        assert_eq!(blends, matches!(row.change.kind, ChangeKind::Blend { .. }), "{row:?}");
    }
    assert!(rows.iter().any(|row| row.rests_on.is_empty()), "{rows:?}");
    assert!(rows.iter().any(|row| !row.rests_on.is_empty()), "{rows:?}");
}

#[test]
fn a_stop_flag_ends_the_search() {
    let program = Program::from_json(PROGRAMS[4]).unwrap();
    let stop = Arc::new(AtomicBool::new(true));
    let stopped = optimiser(&program).interrupted_by(Arc::clone(&stop));
    assert!(stopped.advise(&program).is_err());
    // Set in the middle of the search: no part of a table is returned.
    stop.store(false, Relaxed);
    let calls = AtomicUsize::new(0);
    let rule = |_: &Trajectory| {
        stop.fetch_or(calls.fetch_add(1, Relaxed) > 20, Relaxed);
        true
    };
    assert!(stopped.advise_within(&program, &rule).is_err());
    assert!(calls.load(Relaxed) > 20);
}

/// A named frame may be used elsewhere, too: a change of E1 concerns one motion.
#[test]
fn another_elbow_angle_leaves_the_named_frame() {
    let program = Program::from_json(PROGRAMS[4]).unwrap();
    let named = |motion: &Motion| match motion {
        Motion::Cartesian(cartesian) => matches!(cartesian.target(), Some(TargetRef::Named(_))),
        _ => false,
    };
    let motion = MotionIndex::new(program.motions.iter().position(named).unwrap());
    let kind = ChangeKind::Elbow { from_rad: 0.0, to_rad: 0.1, last: motion };
    let changed = Change { motion, kind }.apply(&program).unwrap();
    assert_eq!(changed.workcell, program.workcell);
    let Motion::Cartesian(cartesian) = &changed.motions[motion.index()] else { panic!() };
    assert!(matches!(cartesian.target(), Some(TargetRef::Given(Target { e1_rad: Some(_), .. }))));
}
