//! Interpolation between points.

use iiwa_kin::{Joints, Robot};
use iiwa_link::TimedJoints;
use iiwa_program::{Motion, Program, Ptp, Sources, Start, Workcell};
use proptest::prelude::*;

use crate::timed_joints::{
    ramp::Ramp,
    sampled::{distance, even, planned, programs},
};

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 150,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn the_interpolation_follows_the_planned_motion(program in programs()) {
        let plan = planned(&program);
        let trajectory = even(&plan, 0.004);
        for (t_s, q) in trajectory.t_s.iter().zip(&trajectory.joints_rad) {
            let off = distance(&trajectory.at(*t_s), q);
            prop_assert!(off < 1e-12, "{} rad at {} s", off, t_s);
        }
        let end_s = trajectory.duration_s();
        // The error of a cubic with approximate slopes at a jerk step: half a microradian for the
        // large joints, two for the wrists.
        let jerk = Robot::default().limits().jerk_rad_s3;
        let max_error = jerk.map(|jerk| jerk * 0.004_f64.powi(3) / 20.0);
        let steps = (end_s / 0.0005) as u32;
        for i in 0..=steps {
            let t_s = f64::from(i) * 0.0005;
            let (actual, expected) = (trajectory.at(t_s), plan.at(t_s).q);
            for j in 0..7 {
                let off = (actual[j] - expected[j]).abs();
                prop_assert!(
                    off < max_error[j],
                    "joint {} is off by {} rad at {} s",
                    j + 1,
                    off,
                    t_s
                );
            }
            // The velocity is continuous, up to its change within this short time.
            let dt_s = 1e-6;
            let [a, b, c] = [t_s - dt_s, t_s, t_s + dt_s].map(|t_s| trajectory.at(t_s));
            for j in 0..7 {
                let jump = (c[j] - 2.0 * b[j] + a[j]).abs() / dt_s;
                prop_assert!(jump < 1e-3, "a jump of {} rad/s at {} s", jump, t_s);
            }
        }
        prop_assert_eq!(trajectory.at(-1.0), trajectory.joints_rad[0]);
        prop_assert_eq!(trajectory.at(end_s + 1.0), *trajectory.joints_rad.last().unwrap());
    }
}

/// Returns programs without blends, with stops anywhere within the joint ranges and at their ends.
fn programs_to_the_limits() -> impl Strategy<Value = Program> {
    let range = Robot::default().limits().upper_rad;
    let place = move |share: [f64; 7]| -> Joints {
        std::array::from_fn(|j| (1.5 * share[j]).clamp(-1.0, 1.0) * range[j])
    };
    let target = (prop::array::uniform7(-1.0..1.0_f64), 0.1..1.0_f64);
    (prop::array::uniform7(-1.0..1.0_f64), prop::collection::vec(target, 1..5)).prop_map(
        move |(start, targets)| Program {
            robot: None,
            start: Start::Joints(place(start)),
            motions: targets
                .into_iter()
                .map(|(share, speed)| Motion::Ptp(Ptp::to(place(share)).velocity(speed)))
                .collect(),
            workcell: Workcell::default(),
            sources: Sources::default(),
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 60,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// No joint overshoots its stop positions, at the ends of its range and elsewhere.
    #[test]
    fn no_joint_overshoots_its_stops(
        program in programs_to_the_limits(),
        step_s in 0.001..0.01_f64,
    ) {
        let trajectory = even(&planned(&program), step_s);
        let targets = program.motions.iter().filter_map(|motion| match motion {
            Motion::Ptp(ptp) => Some(ptp.target_rad),
            _ => None,
        });
        let stops: Vec<Joints> = targets.chain([*program.start.joints_rad().unwrap()]).collect();
        let bound = |j: usize, select: fn(f64, f64) -> f64| {
            stops.iter().map(|stop| stop[j]).reduce(select).unwrap()
        };
        let steps = (trajectory.duration_s() / 0.0003) as u32;
        for q in (0..=steps).map(|i| trajectory.at(f64::from(i) * 0.0003)) {
            for (j, q) in q.iter().enumerate() {
                let beyond = (q - bound(j, f64::max)).max(bound(j, f64::min) - q);
                prop_assert!(beyond < 1e-12, "joint {} by {} rad", j + 1, beyond);
            }
        }
    }

    /// For arbitrary points, the robot remains between them next to rest.
    #[test]
    fn beside_rest_the_interpolation_stays_between_the_points(
        steps in prop::collection::vec(
            (1e-3..0.02_f64, prop_oneof![2 => Just(0.0), 3 => -0.01..0.01_f64]),
            2..20,
        ),
        share in 0.0..1.0_f64,
    ) {
        let (mut t_s, mut q) = (vec![0.0], vec![0.0]);
        for (step_s, by) in steps {
            t_s.push(t_s.last().unwrap() + step_s);
            q.push(q.last().unwrap() + by);
        }
        let joints_rad = q.iter().map(|q| [*q; 7]).collect();
        let trajectory = TimedJoints { t_s: t_s.clone(), joints_rad };
        let rests = |i: usize| {
            i == 0 || i + 1 == q.len() || q[i] == q[i - 1] || q[i] == q[i + 1]
        };
        for i in 0..q.len() - 1 {
            if rests(i) || rests(i + 1) {
                let actual = trajectory.at(t_s[i] + share * (t_s[i + 1] - t_s[i]))[0];
                let (low, high) = (q[i].min(q[i + 1]), q[i].max(q[i + 1]));
                prop_assert!(
                    (low - 1e-12..=high + 1e-12).contains(&actual),
                    "{low} {actual} {high}"
                );
            }
        }
    }
}

#[test]
fn the_epoch_of_the_stamps_does_not_matter() {
    let trajectory = Ramp::new(1.0, 1.0, 5.0, 50.0).sampled(0, 0.004);
    let mut later = trajectory.clone();
    later.t_s.iter_mut().for_each(|t_s| *t_s += 1.7e9);
    for i in 0..2000_u32 {
        let t_s = f64::from(i) * 7e-4;
        let off = distance(&trajectory.at(t_s), &later.at(t_s));
        // The resolution of a stamp of that size is a quarter of a microsecond.
        assert!(off < 1e-6, "{off}");
    }
}
