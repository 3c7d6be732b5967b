//! Playback of a trajectory, with stops on its path.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::{Blend, Motion as Entry, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{
    Timing, Trajectory,
    playback::{Playback, STOP_S},
};

fn planned() -> Trajectory {
    let targets = [
        [0.8, 0.5, 0.0, -1.0, 0.4, 0.9, -1.0],
        [0.2, 1.0, 0.6, -0.4, -0.8, -0.5, 1.5],
        [-0.9, 0.2, -0.4, -1.5, 0.0, 1.2, 0.0],
    ];
    let mut motions: Vec<_> =
        targets.map(|target| Ptp::to(target).blend(Blend::Fraction(0.3))).into();
    motions[2].blend = None;
    let motions = motions.into_iter().map(Entry::Ptp).collect();
    let program = Program {
        robot: None,
        start: Start::Joints([0.0; 7]),
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let path = JointPath::new(&program, &Robot::default()).unwrap();
    Trajectory::plan(&path, Timing::jerk_limited()).unwrap()
}

/// A stop at any time keeps the path and the velocity limits, and exceeds the acceleration limits
/// only slightly.
#[test]
fn a_stop_keeps_to_path_and_limits() {
    const DT_S: f64 = 0.001;
    let plan = planned();
    let limits = *Robot::default().limits();
    let mut worst = [0.0_f64; 2];
    for tenth in 0..200 {
        let at_s = f64::from(tenth) / 200.0 * plan.cycle_time_s();
        let mut playback = Playback::new(plan.clone());
        playback.advance(at_s);
        let mut q = vec![playback.position(); 2];
        playback.stop(STOP_S);
        let mut cycles = 0;
        while !playback.is_over() {
            playback.advance(DT_S);
            q.push(playback.position());
            cycles += 1;
        }
        assert!(f64::from(cycles) * DT_S <= STOP_S + DT_S);
        assert_eq!(q.last(), Some(&plan.at(playback.at_s()).q));
        q.extend_from_within(q.len() - 1..);
        for three in q[2..].windows(3) {
            let [a, b, c] = [three[0], three[1], three[2]];
            for (j, b) in b.iter().enumerate() {
                let speed = (b - a[j]).abs() / DT_S;
                let bend = (c[j] - 2.0 * b + a[j]).abs() / DT_S / DT_S;
                worst[0] = worst[0].max(speed / limits.velocity_rad_s[j]);
                worst[1] = worst[1].max(bend / limits.acceleration_rad_s2[j]);
            }
        }
    }
    assert!(worst[0] < 1.01 && worst[1] < 1.24, "{worst:?}");
}
