//! An updated path equals the path of its program.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use iiwa_kin::Robot;
use iiwa_path::{Corner, JointPath, PathOptions, Step};
use iiwa_program::{
    Blend, Course, LimitKind, Load, Motion, MotionIndex, OperatingMode, Program, Ptp, Sources,
    Start, TargetRef, Workcell,
};
use proptest::prelude::*;

fn motion() -> impl Strategy<Value = Motion> {
    let target = prop_oneof![
        4 => prop::array::uniform7(-1.0..1.0_f64),
        // A repeated target, or one straight on, makes the path omit steps.
        1 => (0..3_i32).prop_map(|place| [0.2 * f64::from(place), 0.0, 0.0, -0.5, 0.0, 0.0, 0.0]),
    ];
    let blend = prop_oneof![
        1 => Just(None),
        3 => (0.0..0.5_f64).prop_map(|share| Some(Blend::Fraction(share))),
        1 => (0.0..100.0_f64).prop_map(|radius| Some(Blend::CartMm(radius))),
    ];
    prop_oneof![
        5 => (target, blend, 0.1..1.0_f64).prop_map(|(target, blend, velocity)| {
            Motion::Ptp(Ptp { blend, ..Ptp::to(target).velocity(velocity) })
        }),
        1 => (0.0..2.0_f64).prop_map(|seconds| Motion::Wait { seconds, overlap: 0 }),
        1 => prop::option::of(0.0..9.0_f64).prop_map(|mass| {
            Motion::Load(mass.map(|mass_kg| Load { mass_kg, ..Load::default() }.into()))
        }),
    ]
}

/// Removes blends without a motion after them.
fn cleaned(motions: Vec<Motion>) -> Vec<Motion> {
    let leads_on: Vec<_> =
        motions.iter().skip(1).map(|next| matches!(next, Motion::Ptp(_))).chain([false]).collect();
    let clean = |(motion, leads_on): (Motion, bool)| match motion {
        Motion::Ptp(ptp) if !leads_on => Motion::Ptp(Ptp { blend: None, ..ptp }),
        other => other,
    };
    motions.into_iter().zip(leads_on).map(clean).collect()
}

proptest! {
    #[test]
    fn is_that_of_the_program(
        motions in prop::collection::vec(motion(), 1..8),
        changes in prop::collection::vec((0..8_usize, motion()), 1..6),
    ) {
        let robot = Robot::default();
        let options = PathOptions::default();
        let mut program = Program {
            robot: None,
            start: Start::Joints([0.0; 7]),
            motions: cleaned(motions),
            workcell: Workcell::default(),
            sources: Sources::default(),
        };
        let mut path = JointPath::new(&program, &robot).unwrap();
        for (index, motion) in changes {
            let index = index % program.motions.len();
            let old = std::mem::replace(&mut program.motions[index], motion);
            let before = path.clone();
            let updated = path.update(&program, options, MotionIndex::new(index));
            match (JointPath::new(&program, &robot), updated) {
                (Ok(new), Ok(replaced)) => {
                    prop_assert_eq!(format!("{:?}", path.steps()), format!("{:?}", new.steps()));
                    prop_assert_eq!(path.limits(), new.limits());
                    for index in (0..program.motions.len()).map(MotionIndex::new) {
                        prop_assert_eq!(path.load(index), new.load(index));
                    }
                    let is_shared = |path: &JointPath, range: &std::ops::Range<usize>| {
                        let steps = path.steps();
                        format!("{:?} {:?}", &steps[..range.start], &steps[range.end..])
                    };
                    prop_assert_eq!(
                        is_shared(&before, &replaced.before),
                        is_shared(&path, &replaced.after)
                    );
                }
                (Err(fault), Err(same)) => {
                    prop_assert_eq!(fault, same);
                    prop_assert_eq!(format!("{:?}", path.steps()), format!("{:?}", before.steps()));
                    program.motions[index] = old;
                }
                (new, updated) => prop_assert!(false, "{:?} {:?}", new.map(|_| ()), updated),
            }
        }
    }
}

#[test]
fn replaces_little_of_a_long_path() {
    let corner = |i: i32| {
        let turn = f64::from(i % 2);
        Motion::Ptp(
            Ptp::to([0.5 * turn, 0.01 * f64::from(i), 0.0, -1.0, 0.0, 0.5, 0.0])
                .blend(Blend::Fraction(0.3)),
        )
    };
    let mut motions: Vec<_> = (0..100).map(corner).collect();
    motions.push(Motion::Ptp(Ptp::to([0.0; 7])));
    let mut program = Program {
        robot: None,
        start: Start::Joints([0.0; 7]),
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let mut path = JointPath::new(&program, &Robot::default()).unwrap();
    let Motion::Ptp(ptp) = &mut program.motions[50] else { panic!() };
    ptp.target_rad[0] += 0.1;
    let target = path.update(&program, PathOptions::default(), MotionIndex::new(50)).unwrap();
    // Three blends, the two lines in between, and one line on either side.
    assert_eq!(target.after.len(), 7);
    assert_eq!(target.before, target.after);

    let Motion::Ptp(ptp) = &mut program.motions[50] else { panic!() };
    ptp.velocity_rel = [0.5; 7];
    let speed = path.update(&program, PathOptions::default(), MotionIndex::new(50)).unwrap();
    // The line of the motion, and the blend that leads into it.
    assert_eq!(speed.after.len(), 2);
    let nothing = path.update(&program, PathOptions::default(), MotionIndex::new(50)).unwrap();
    assert!(nothing.after.is_empty() && nothing.before.is_empty());
}

/// A program with 24 motions to frames, of which every third has its own E1.
fn frames() -> Program {
    let motion = |i: usize| {
        let [x, y, z] =
            [450 + 20 * (i % 4), 40 * (i % 5), if i.is_multiple_of(2) { 300 } else { 380 }];
        let e1 = if i.is_multiple_of(3) {
            format!(r#", "e1_deg": {}"#, 3 + i % 5)
        } else {
            String::new()
        };
        let blend = if i < 23 && i % 7 != 5 { r#", "blend": { "cart_mm": 15 }"# } else { "" };
        let kind = if i % 5 == 1 { "ptp" } else { "lin" };
        let frame = format!(
            r#"{{ "x_mm": {x}, "y_mm": {y}, "z_mm": {z}, "a_deg": 0, "b_deg": 180,
                  "c_deg": 0{e1} }}"#
        );
        format!(r#"{{ "type": "{kind}", "frame": {frame}{blend} }}"#)
    };
    let motions: Vec<_> = (0..24).map(motion).collect();
    let start = r#"{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }"#;
    let text = format!(
        r#"{{ "version": 1, "tools": {{ "pen": {{ "tcp": {{ "z_mm": 30 }} }} }},
              "start": {start}, "motions": [{}] }}"#,
        motions.join(", ")
    );
    Program::from_json(&text).unwrap()
}

/// Largest difference of joint positions and their derivatives between two paths with the same
/// steps.
fn difference(a: &JointPath, b: &JointPath) -> f64 {
    assert_eq!(a.steps().len(), b.steps().len());
    let mut largest: f64 = 0.0;
    for (a, b) in a.steps().iter().zip(b.steps()) {
        match (a, b) {
            (
                Step::Move { motion, segment, blend, limits },
                Step::Move { motion: of, segment: other, blend: other_blend, limits: other_limits },
            ) => {
                let corner = |blend: &Option<Corner>| blend.as_ref().map(|corner| corner.motion);
                assert_eq!((motion, corner(blend)), (of, corner(other_blend)));
                assert_eq!(limits, other_limits);
                for s in [0.0, 0.3, 0.7, 1.0] {
                    let [a, b] = [segment, other].map(|segment| (segment.at(s), segment.sigma(s)));
                    let joints = a.0.q.iter().chain(&a.0.dq).zip(b.0.q.iter().chain(&b.0.dq));
                    for (x, y) in joints.chain(a.1.iter().zip(&b.1)) {
                        largest = largest.max((x - y).abs());
                    }
                }
            }
            (a, b) => assert_eq!(format!("{a:?}"), format!("{b:?}")),
        }
    }
    largest
}

/// Text of the steps outside a range.
fn outside(path: &JointPath, range: &std::ops::Range<usize>) -> String {
    format!("{:?} {:?}", &path.steps()[..range.start], &path.steps()[range.end..])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Changes of E1, heights, speeds, tools and kinds in a program with frames.
    #[test]
    fn is_that_of_the_program_with_frames(
        [is_t1, is_prepared] in any::<[bool; 2]>(),
        changes in prop::collection::vec((0..24_usize, 0..8_u8, 0.0..1.0_f64), 1..6),
    ) {
        let robot = Robot::default();
        let options = PathOptions::default();
        let mut program = frames();
        if is_t1 {
            program.workcell.mode = OperatingMode::T1;
        }
        let mut path = JointPath::new(&program, &robot).unwrap();
        if is_prepared {
            path.prepare_updates(&program).unwrap();
        }
        for (index, kind, share) in changes {
            let before = program.motions[index].clone();
            change(&mut program, index, kind, share);
            let old = path.clone();
            let updated = path.update(&program, options, MotionIndex::new(index));
            match (JointPath::new(&program, &robot), updated) {
                (Ok(new), Ok(replaced)) => {
                    prop_assert!(difference(&path, &new) < 1e-9);
                    prop_assert_eq!(path.limits(), new.limits());
                    prop_assert_eq!(
                        outside(&old, &replaced.before),
                        outside(&path, &replaced.after)
                    );
                }
                (Err(fault), Err(same)) => {
                    prop_assert_eq!(fault.motion(), same.motion());
                    prop_assert_eq!(format!("{:?}", path.steps()), format!("{:?}", old.steps()));
                    program.motions[index] = before;
                }
                (new, updated) => prop_assert!(false, "{:?} {:?}", new.map(|_| ()), updated),
            }
        }
    }
}

/// Changes a motion of [`frames`].
fn change(program: &mut Program, index: usize, kind: u8, share: f64) {
    let blend = program.motions.get(index + 1).is_some_and(Motion::moves);
    let Motion::Cartesian(motion) = &mut program.motions[index] else {
        // A motion to joints or a wait becomes a motion to a frame again.
        program.motions[index] = frames().motions[index].clone();
        return;
    };
    let (Course::Ptp { to } | Course::Lin { to }) = &mut motion.course else { unreachable!() };
    let TargetRef::Given(target) = to else { unreachable!() };
    match kind {
        0 => target.e1_rad = Some(0.4 * share - 0.2),
        1 => target.frame.xyz_mm[2] = 300.0 + 100.0 * share,
        // Out of reach.
        2 => target.frame.xyz_mm[2] = 2000.0,
        3 => motion.shares[LimitKind::Velocity] = [0.2 + 0.8 * share; 7],
        4 => motion.blend = blend.then(|| Blend::CartMm(5.0 + 20.0 * share).into()),
        5 => motion.tool = (motion.tool.is_none()).then(|| "pen".to_owned()),
        6 => {
            let target_rad = [0.1, 0.5, 0.0, -1.2, 0.0, 1.2 + 0.2 * share, 0.0];
            program.motions[index] = Motion::Ptp(Ptp::to(target_rad));
        }
        _ => target.e1_rad = None,
    }
}

/// Motions after the change that start where they did are kept.
#[test]
fn replaces_little_of_a_path_with_frames() {
    let mut program = frames();
    let mut path = JointPath::new(&program, &Robot::default()).unwrap();
    path.prepare_updates(&program).unwrap();
    for e1_rad in [0.1, 0.12] {
        let Motion::Cartesian(motion) = &mut program.motions[9] else { unreachable!() };
        let Course::Lin { to: TargetRef::Given(target) } = &mut motion.course else {
            unreachable!()
        };
        target.e1_rad = Some(e1_rad);
        let old = path.clone();
        let motion = MotionIndex::new(9);
        let replaced = path.update(&program, PathOptions::default(), motion).unwrap();
        // From the blend before motion 9 to motion 12, which has its own E1.
        assert!(replaced.after.len() <= 9, "{replaced:?}");
        let kept = |path: &JointPath, range: &std::ops::Range<usize>| -> Vec<_> {
            let (before, after) = (&path.steps()[..range.start], &path.steps()[range.end..]);
            let segment = |step: &Step| match step {
                Step::Move { segment, .. } => Some(Arc::as_ptr(segment).cast::<()>()),
                _ => None,
            };
            before.iter().chain(after).map(segment).collect()
        };
        assert_eq!(kept(&old, &replaced.before), kept(&path, &replaced.after));
        assert!(difference(&path, &JointPath::new(&program, &Robot::default()).unwrap()) < 1e-9);
    }
}
