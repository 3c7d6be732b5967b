//! An updated path equals the path of its program.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use iiwa_kin::Robot;
use iiwa_path::{JointPath, PathOptions};
use iiwa_program::{Blend, Load, Motion, MotionIndex, Program, Ptp, Sources, Start, Workcell};
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
