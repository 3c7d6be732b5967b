//! Interruption of the planner.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::{Blend, Fault, Program};
use iiwa_traj::{Planner, SweepOptions, Timing, TimingError};

/// Creates motions to and fro, all blended: one section.
fn path(motions: u32) -> Result<JointPath, Fault> {
    let mut program = Program::from_deg([0.0; 7]);
    for i in 0..motions {
        let [a, b] = [f64::from(i % 7), f64::from(i % 5)].map(|v| 10.0 * v);
        let motion = program.ptp_deg([a, b, 0.0, -a - 20.0, 0.0, b, 0.0]);
        program = if i + 1 < motions { motion.blend(Blend::Fraction(0.25)) } else { motion };
    }
    JointPath::new(&program.build(), &Robot::default())
}

#[test]
fn ends_in_an_error_with_either_timing() {
    let timings = [Timing::jerk_limited(), Timing::Acceleration(SweepOptions::default())];
    for timing in timings {
        let stop = Arc::new(AtomicBool::new(true));
        let mut planner =
            Planner::new(&path(20).unwrap(), timing).interrupted_by(Arc::clone(&stop));
        assert_eq!(planner.next().unwrap().unwrap_err(), TimingError::Interrupted);
        // The iterator ends after an error.
        stop.store(false, Ordering::Relaxed);
        assert!(planner.next().is_none());
    }
}

#[test]
fn stops_in_the_middle_of_a_section() {
    // On a busy machine, a program may be complete before it is interrupted: then a longer one is
    // tried.
    let stopped = [500, 4_000, 16_000].into_iter().any(|motions| {
        let path = path(motions).unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let mut planner =
            Planner::new(&path, Timing::jerk_limited()).interrupted_by(Arc::clone(&stop));
        let actual = thread::scope(|scope| {
            let planning = scope.spawn(move || planner.next());
            thread::sleep(Duration::from_millis(20));
            stop.store(true, Ordering::Relaxed);
            planning.join().unwrap()
        });
        actual.unwrap().is_err_and(|error| error == TimingError::Interrupted)
    });
    assert!(stopped);
}
