//! A path of a shape from outside the workspace crates is planned like any other, with either
//! timing.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use std::{f64::consts::PI, sync::Arc};

use iiwa_kin::{Joints, Robot};
use iiwa_path::{Derivatives, JoinError, JointPath, Line, Segment, Step};
use iiwa_program::{MotionIndex, MotionLimits};
use iiwa_traj::{PieceKind, Section, SweepOptions, Timing, Trajectory};

/// Joint 1 moves uniformly while joint 4 swings out and back as `a sin(pi s)^4`: its first three
/// derivatives vanish at both ends, so that lines of joint 1 can follow. All in rad.
#[derive(Debug)]
struct Swing {
    from: f64,
    length: f64,
    amplitude: f64,
}

impl Segment for Swing {
    fn at(&self, s: f64) -> Derivatives {
        let (sin, cos) = (PI * s).sin_cos();
        let a = self.amplitude;
        let joint_1_and_4 =
            |one: f64, four: f64| -> Joints { [one, 0.0, 0.0, four, 0.0, 0.0, 0.0] };
        Derivatives {
            q: joint_1_and_4(self.from + self.length * s, a * sin.powi(4)),
            dq: joint_1_and_4(self.length, a * 4.0 * PI * sin.powi(3) * cos),
            ddq: joint_1_and_4(
                0.0,
                a * 4.0 * PI.powi(2) * sin.powi(2) * (3.0 * cos * cos - sin * sin),
            ),
            dddq: joint_1_and_4(
                0.0,
                a * 4.0 * PI.powi(3) * sin * cos * (6.0 * cos * cos - 10.0 * sin * sin),
            ),
        }
    }

    fn bend_bound_rad(&self) -> Joints {
        [0.0, 0.0, 0.0, 12.0 * PI * PI * self.amplitude, 0.0, 0.0, 0.0]
    }
}

/// Creates a line, the swing and a line, without a stop.
fn path() -> JointPath {
    let robot = Robot::default();
    let joint_1 = |q: f64| [q, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let segments: [Arc<dyn Segment>; 3] = [
        Arc::new(Line::new(joint_1(-1.0), joint_1(-0.4))),
        Arc::new(Swing { from: -0.4, length: 0.8, amplitude: 0.3 }),
        Arc::new(Line::new(joint_1(0.4), joint_1(1.0))),
    ];
    let steps = segments.into_iter().map(|segment| Step::Move {
        motion: MotionIndex::default(),
        segment,
        blend: None,
        limits: None,
    });
    let limits = MotionLimits::full(&robot);
    JointPath::from_steps(&robot, joint_1(-1.0), steps.collect(), vec![limits]).unwrap()
}

#[test]
fn a_custom_segment_is_planned_within_the_limits() {
    let path = path();
    let limits = *path.robot().limits();
    for (timing, jerk) in [
        (Timing::Acceleration(SweepOptions::default()), f64::INFINITY),
        (Timing::jerk_limited(), 1.05),
    ] {
        let trajectory = Trajectory::plan(&path, timing).unwrap();
        let pieces: Vec<_> = trajectory.sections().iter().flat_map(Section::pieces).collect();
        assert!(pieces.iter().take(3).all(|piece| piece.kind != PieceKind::Settle));
        // Joint 4 moves on the way.
        let middle = trajectory.at(0.5 * trajectory.motion_time_s());
        assert!((middle.q[3] - 0.3).abs() < 1e-3, "{middle:?}");
        // Positions, velocities, accelerations and jerks are consistent, and keep the limits.
        let step_s = 1e-5;
        let count = 2_000;
        for i in 1..count {
            let t_s = trajectory.motion_time_s() * f64::from(i) / f64::from(count);
            let [before, middle, after] = [-1.0, 0.0, 1.0].map(|k| trajectory.at(t_s + k * step_s));
            for j in 0..7 {
                let share = |value: f64, limit: f64| value.abs() / limit;
                assert!(share(middle.dq[j], limits.velocity_rad_s[j]) < 1.005);
                assert!(share(middle.ddq[j], limits.acceleration_rad_s2[j]) < 1.01);
                assert!(
                    share(middle.dddq[j], limits.jerk_rad_s3[j]) < jerk,
                    "{} s: {middle:?}",
                    middle.t_s
                );
                let rate = (after.q[j] - before.q[j]) / (2.0 * step_s);
                assert!((rate - middle.dq[j]).abs() < 1e-3, "{rate} {middle:?}");
            }
        }
    }
}

#[test]
fn steps_have_to_join() {
    let robot = Robot::default();
    let line = |from: Joints, to: Joints| Step::Move {
        motion: MotionIndex::default(),
        segment: Arc::new(Line::new(from, to)),
        blend: None,
        limits: None,
    };
    let along = |a: f64, b: f64| [a, b, 0.0, 0.0, 0.0, 0.0, 0.0];
    let path_of = |steps: Vec<Step>| {
        let limits = vec![MotionLimits::full(&robot)];
        JointPath::from_steps(&robot, [0.0; 7], steps, limits).err()
    };
    let first = || line(along(0.0, 0.0), along(0.5, 0.0));
    assert_eq!(path_of(vec![first(), line(along(0.5, 0.0), along(1.0, 0.0))]), None);
    let gap = path_of(vec![first(), line(along(0.6, 0.0), along(1.0, 0.0))]);
    assert!(matches!(gap, Some(JoinError::Gap { step: 1, .. })));
    let kink = path_of(vec![first(), line(along(0.5, 0.0), along(0.5, 0.5))]);
    assert_eq!(kink, Some(JoinError::Kink { step: 1 }));
    let stops = path_of(vec![
        first(),
        Step::Corner { motion: MotionIndex::new(0), place: None },
        line(along(0.5, 0.0), along(0.5, 0.5)),
    ]);
    assert_eq!(stops, None);
    let mut other = first();
    if let Step::Move { motion, .. } = &mut other {
        *motion = MotionIndex::new(3);
    }
    assert_eq!(
        path_of(vec![other]),
        Some(JoinError::NoLimits { step: 0, motion: MotionIndex::new(3) })
    );
}
