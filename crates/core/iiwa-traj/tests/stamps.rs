//! Stamps increase, even where steps have no duration.

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::{Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{Timing, Trajectory};

fn wait(seconds: f64) -> Motion {
    Motion::Wait { seconds, overlap: 0 }
}

#[test]
fn a_wait_of_no_time_has_no_stamp() {
    let target = Ptp::to([0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let motions = vec![
        wait(0.0),
        Motion::Ptp(target.clone()),
        wait(0.0),
        wait(0.5),
        // Below the resolution of floating-point numbers at half a second.
        wait(1e-18),
        Motion::Ptp(target),
        wait(0.0),
    ];
    let program = Program {
        robot: None,
        start: Start::Joints([0.0; 7]),
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let path = JointPath::new(&program, &Robot::default()).unwrap();
    let plan = Trajectory::plan(&path, Timing::jerk_limited()).unwrap();
    for pair in plan.states().collect::<Vec<_>>().windows(2) {
        assert!(pair[0].t_s < pair[1].t_s, "{pair:?}");
    }
    let pieces = plan.sections().iter().flat_map(iiwa_traj::Section::pieces);
    assert!(pieces.clone().all(|piece| piece.start_s < piece.end_s));
    assert_eq!(pieces.count(), 4);
    let motions: Vec<_> = plan.motions().iter().map(|figures| figures.motion.index()).collect();
    assert_eq!(motions, [1, 3, 5]);
    assert_eq!(plan.totals().wait_time_s, 0.5);
}

#[test]
fn a_program_may_take_no_time_at_all() {
    let program = Program {
        robot: None,
        start: Start::Joints([0.1; 7]),
        motions: vec![wait(0.0)],
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let path = JointPath::new(&program, &Robot::default()).unwrap();
    let plan = Trajectory::plan(&path, Timing::jerk_limited()).unwrap();
    assert_eq!((plan.cycle_time_s(), plan.states().count()), (0.0, 1));
    assert_eq!(plan.at(0.0).q, [0.1; 7]);
}
