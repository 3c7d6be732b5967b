//! Planning of the sections of a long path on several threads.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::sync::{Arc, atomic::AtomicBool};

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::{Blend, Program};
use iiwa_traj::{Planner, Section, Timing, TimingError};

/// Creates motions to and fro, with a stop after every fourth motion.
fn path(motions: u32) -> JointPath {
    let mut program = Program::from_deg([0.0; 7]);
    for i in 0..motions {
        let [a, b] = [f64::from(i % 7), f64::from(i % 5)].map(|v| 10.0 * v);
        let motion = program.ptp_deg([a, b, 0.0, -a - 20.0, 0.0, b, 0.0]);
        program = if i % 4 < 3 { motion.blend(Blend::Fraction(0.25)) } else { motion };
    }
    JointPath::new(&program.build(), &Robot::default()).unwrap()
}

fn planner(path: &JointPath, threads: usize) -> Planner {
    Planner::new(path, Timing::default()).with_threads(threads)
}

/// All numbers of a section, to the last bit.
fn bits(section: &Section) -> Vec<u64> {
    let states = section.states().flat_map(|state| {
        [vec![state.t_s], state.q.to_vec(), state.dq.to_vec(), state.ddq.to_vec()].concat()
    });
    let times = section
        .pieces()
        .iter()
        .flat_map(|piece| [piece.start_s, piece.end_s, piece.duration_s, piece.peak_velocity_rel]);
    states.chain(times).map(f64::to_bits).collect()
}

#[test]
fn plans_are_equal_to_the_last_bit() {
    let path = path(240);
    let all = |threads| -> Vec<Vec<u64>> {
        planner(&path, threads).map(|section| bits(&section.unwrap())).collect()
    };
    let expected = all(1);
    assert_eq!(expected.len(), 60);
    for threads in [2, 3, 8] {
        assert!(all(threads) == expected, "{threads} threads");
    }
}

#[test]
fn a_planner_restarts_in_the_middle_of_a_path() {
    let [long, longer] = [path(160), path(200)];
    let mut planner = planner(&long, 2);
    assert!(planner.nth(7).unwrap().is_ok());
    planner.restart(&longer);
    let sections: Vec<_> = planner.map(|section| bits(&section.unwrap())).collect();
    let expected: Vec<_> =
        self::planner(&longer, 1).map(|section| bits(&section.unwrap())).collect();
    assert!(sections == expected);
}

#[test]
fn interrupts_end_all_threads() {
    let stop = Arc::new(AtomicBool::new(true));
    let mut planner = planner(&path(160), 2).interrupted_by(Arc::clone(&stop));
    assert_eq!(planner.next().unwrap().unwrap_err(), TimingError::Interrupted);
    assert!(planner.next().is_none());
}

/// Two sections with far more moves than are planned ahead, behind a wait.
#[test]
fn long_sections_are_planned_ahead() {
    let half = |first: u32, mut program: iiwa_program::ProgramBuilder| {
        for i in first..first + 130 {
            let angle = f64::from(i % 7) * 10.0;
            program = program.ptp_deg([angle, 0.0, 0.0, -angle - 20.0, 0.0, 0.0, 0.0]);
            if i < first + 129 {
                program = program.blend(Blend::Fraction(0.25));
            }
        }
        program
    };
    let program = half(130, half(0, Program::from_deg([0.0; 7]).wait_s(0.5))).build();
    let path = JointPath::new(&program, &Robot::default()).unwrap();
    let all = |threads| -> Vec<Vec<u64>> {
        planner(&path, threads).map(|section| bits(&section.unwrap())).collect()
    };
    assert!(all(2) == all(1));
}

/// A planner that waits for its threads to end does not wait for their work.
#[test]
fn a_planner_can_be_dropped_in_the_middle_of_a_path() {
    let path = path(400);
    let mut planner = planner(&path, 2);
    assert!(planner.next().unwrap().is_ok());
    drop(planner);
}
