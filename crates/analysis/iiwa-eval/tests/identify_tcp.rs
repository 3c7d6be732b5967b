//! Identification of virtual robots whose TCP blends differ from the model's.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use fastrand::Rng;
use iiwa_eval::{
    Estimate, VirtualRobot,
    experiment::{TcpSeries, Trial, tcp_blends},
    identify::{CoursePart, Identified, RecordedRun, Why, identify},
};
use iiwa_kin::{
    Joints, Pose, Robot, Status,
    rotation::{apply, exp, product},
};
use iiwa_log::JointLog;
use iiwa_path::{JointPath, Step};

fn models() -> impl Iterator<Item = Robot> {
    Robot::BUILT_IN.iter().map(|name| Robot::built_in(name).unwrap())
}

/// kappa of the TCP blends differs by up to 1.5 from that of the joint blends at 0, 90 and 180 deg.
fn any_robot(model: &Robot, random: &mut Rng) -> Robot {
    let [a, b, c] =
        [0.0, 90.0, 180.0].map(|gamma_deg| model.kappa(gamma_deg) + 3.0 * (random.f64() - 0.5));
    let square = (a - 2.0 * b + c) / (2.0 * 90.0 * 90.0);
    model.clone().with_tcp_blend_kappa([a, (b - a) / 90.0 - 90.0 * square, square])
}

fn identified(trial: &Trial, log: &JointLog, model: &Robot) -> Identified {
    identify(&[RecordedRun { program: &trial.program, log }], model).unwrap()
}

/// Angles at which kappa is checked, in degrees.
fn angles() -> impl Iterator<Item = f64> {
    (1..=17).map(|i| 10.0 * f64::from(i))
}

/// Returns the largest deviations of a part, in mm, deg and deg, and the number of observations.
fn worst(identified: &Identified, part: CoursePart) -> ([f64; 3], usize) {
    let of_part = identified.courses.iter().filter(|course| course.part == part);
    of_part.fold(([0.0; 3], 0), |([off, turn, e1], count), course| {
        let off = off.max(1e3 * course.off_m);
        let turn = turn.max(course.turn_off_rad.to_degrees());
        ([off, turn, e1.max(course.e1_off_rad.to_degrees())], count + 1)
    })
}

/// Without noise, all results are exact for any kappa of the TCP.
#[test]
fn simulated_blends_are_identified() {
    let mut random = Rng::with_seed(1);
    let trial = tcp_blends(&TcpSeries::ALL);
    for model in models() {
        let truth = any_robot(&model, &mut random);
        let log = VirtualRobot::new(truth.clone(), 1).run(&trial.program).unwrap();
        let actual = identified(&trial, &log, &model);
        assert_eq!(actual.left_out, []);
        let kappa = actual.tcp_kappa.unwrap();
        for gamma in angles() {
            let (actual, truth) = (kappa.at(gamma).value, truth.tcp_kappa(gamma));
            let error = (actual - truth).abs() / truth.abs().max(1.0);
            assert!(error < 1e-3, "{} at {gamma} deg: {actual}, {truth}", model.name());
        }
        assert!(kappa.residual_of_model > 0.1 && kappa.residual < 1e-3);
        let reach = actual.tcp_reach.unwrap();
        for reach in reach {
            assert!((reach.value - 1.0).abs() < 1e-3 && reach.count > 15, "{reach:?}");
        }
        let share = actual.tcp_unequal_share.unwrap();
        assert!(share.value.abs() < 1e-3 && share.count == 10, "{share:?}");
        // The assumptions about orientation, E1 and blends with joint space hold.
        for (part, min_count) in CoursePart::ALL.into_iter().zip([40, 20, 8]) {
            let (worst, count) = worst(&actual, part);
            println!("{} {part:?}: {worst:?} in {count}", model.name());
            assert!(count >= min_count, "{part:?}: {count}");
            assert!(worst.iter().all(|worst| *worst < 2e-3), "{part:?}: {worst:?}");
        }
        // All results are in the profile.
        let robot = actual.robot(&model);
        assert_eq!(robot.tcp_blend_kappa(), kappa.coefficients());
        assert_eq!(robot.blend_kappa(), model.blend_kappa());
    }
}

/// With noise, the stated uncertainties are correct.
#[test]
fn random_robots_with_noise() {
    let mut random = Rng::with_seed(2);
    let trial = tcp_blends(&[TcpSeries::Angles, TcpSeries::Shares]);
    let (mut inside, mut count, mut worst) = (0, 0, 0.0_f64);
    let (mut inside_reach, mut count_reach) = (0, 0);
    for model in models() {
        for seed in 0..6 {
            let truth = any_robot(&model, &mut random);
            let mut robot = VirtualRobot::new(truth.clone(), seed);
            robot.noise_rad = 1e-5;
            let log = robot.run(&trial.program).unwrap();
            let actual = identified(&trial, &log, &model);
            assert_eq!(actual.left_out, []);
            let kappa = actual.tcp_kappa.unwrap();
            for gamma in angles() {
                let (actual, truth) = (kappa.at(gamma), truth.tcp_kappa(gamma));
                worst = worst.max((actual.value - truth).abs());
                inside += usize::from(actual.holds(truth));
                count += 1;
                assert!(
                    (actual.value - truth).abs() < 3.0 * actual.uncertainty,
                    "{actual:?} {truth}"
                );
            }
            let [before, after] = actual.tcp_reach.unwrap();
            let truths: [(Estimate, f64); 3] =
                [(before, 1.0), (after, 1.0), (actual.tcp_unequal_share.unwrap(), 0.0)];
            for (actual, truth) in truths {
                assert!(actual.uncertainty < 5e-3 && (actual.value - truth).abs() < 5e-3);
                inside_reach += usize::from(actual.holds(truth));
                count_reach += 1;
            }
        }
    }
    println!("kappa: {worst:.2e}, {inside} of {count}; reach: {inside_reach} of {count_reach}");
    assert!(worst < 0.02, "{worst}");
    assert!(inside as f64 >= 0.85 * f64::from(count), "{inside} of {count}");
    assert!(inside_reach >= 31, "{inside_reach} of {count_reach}");
}

/// Returns the joint positions of a flange pose, with E1 and status as in the program.
fn joints(robot: &Robot, pose: &Pose) -> Joints {
    robot.inverse(pose, 0.0, Status::new(0b010).unwrap()).unwrap()
}

/// Returns the log of a robot whose flange poses are those of the plan, changed by `by`.
fn moved(trial: &Trial, robot: &Robot, by: impl Fn(f64, &Pose) -> Pose) -> JointLog {
    let mut log = VirtualRobot::new(robot.clone(), 1).run(&trial.program).unwrap();
    for (t_s, q_rad) in log.t_s.iter().zip(&mut log.q_rad) {
        let pose = robot.flange_pose(q_rad);
        *q_rad = joints(robot, &by(*t_s, &pose));
    }
    log
}

/// Position of the corner, in m.
const CORNER_M: [f64; 3] = [0.52, 0.0, 0.35];

fn from_corner(pose: &Pose) -> f64 {
    let off = |i: usize| pose.position_m[i] - CORNER_M[i];
    off(0).hypot(off(1))
}

/// A hump over the corner, some mm high: not a blend in the plane of the LINs.
#[test]
fn corners_without_blend_are_left_out() {
    let robot = Robot::default();
    let trial = tcp_blends(&[TcpSeries::Angles]);
    let log = moved(&trial, &robot, |_, pose| {
        let mut pose = *pose;
        pose.position_m[2] += 0.008 * (-(from_corner(&pose) / 0.03).powi(2)).exp();
        pose
    });
    let actual = identified(&trial, &log, &robot);
    assert!(actual.tcp_blends.is_empty() && actual.tcp_kappa.is_none());
    let reason =
        |left: &&iiwa_eval::identify::LeftOut| matches!(left.why, Why::NoTcpBlend(mm) if mm > 5e-4);
    assert_eq!(actual.left_out.iter().filter(reason).count(), 17, "{:?}", actual.left_out);
    // The report states the deviation.
    let ([off_mm, ..], _) = worst(&actual, CoursePart::TcpBlend);
    assert!((off_mm - 8.0).abs() < 1.0, "{off_mm}");
}

/// The orientation leads the position by 2 deg half-way along LINs.
#[test]
fn another_orientation_law_is_reported() {
    let robot = Robot::default();
    let trial = tcp_blends(&[TcpSeries::Angles]);
    let ahead_rad = 2_f64.to_radians();
    let log = moved(&trial, &robot, |_, pose| {
        let mut pose = *pose;
        let share = ((from_corner(&pose) - 0.045) / 0.04).clamp(0.0, 1.0);
        let turn = exp(&[0.0, 0.0, ahead_rad * (16.0 * share * share * (1.0 - share).powi(2))]);
        pose.rotation = product(&turn, &pose.rotation);
        pose
    });
    let actual = identified(&trial, &log, &robot);
    let ([off_mm, turn_deg, e1_deg], count) = worst(&actual, CoursePart::Path);
    assert!(count > 40 && off_mm < 1e-3 && e1_deg < 1e-6, "{off_mm} {e1_deg} {count}");
    assert!((turn_deg - 2.0).abs() < 0.01, "{turn_deg}");
    // Within blends the orientation is as assumed, and kappa is identified as well.
    let ([_, turn_deg, _], _) = worst(&actual, CoursePart::TcpBlend);
    assert!(turn_deg < 0.01, "{turn_deg}");
    assert!((actual.tcp_kappa.unwrap().at(90.0).value - robot.kappa(90.0)).abs() < 1e-3);
}

/// A robot whose joint blends have another kappa deviates from the assumed blends of PTP and LIN,
/// and from these only.
#[test]
fn blends_with_joint_space_are_distinguished() {
    let model = Robot::default();
    let truth = model.clone().with_blend_kappa([-1.0, 0.0, 0.0]);
    let truth = truth.with_tcp_blend_kappa(*model.blend_kappa());
    let trial = tcp_blends(&[TcpSeries::Angles, TcpSeries::Joints]);
    let log = VirtualRobot::new(truth.clone(), 1).run(&trial.program).unwrap();
    let actual = identified(&trial, &log, &model);
    let ([off_mm, ..], count) = worst(&actual, CoursePart::JointBlend);
    assert_eq!(count, 8);
    // The deviation equals the distance between the two paths.
    let [assumed, real] =
        [&model, &truth].map(|robot| JointPath::new(&trial.program, robot).unwrap());
    let mut expected_mm = 0.0_f64;
    for (a, b) in assumed.steps().iter().zip(real.steps()) {
        let (Step::Move { segment: a, blend: Some(_), .. }, Step::Move { segment: b, .. }) = (a, b)
        else {
            continue;
        };
        let place = |segment: &dyn iiwa_path::Segment, i: u32| {
            model.flange_position(&segment.at(f64::from(i) / 200.0).q)
        };
        for i in 0..=200 {
            let b = place(b.as_ref(), i);
            let nearest = (0..=200).map(|k| {
                let a = place(a.as_ref(), k);
                (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
            });
            expected_mm = expected_mm.max(1e3 * nearest.fold(f64::MAX, f64::min));
        }
    }
    assert!(
        expected_mm > 0.3 && (off_mm / expected_mm - 1.0).abs() < 0.05,
        "{off_mm} {expected_mm}"
    );
    let ([off_mm, ..], _) = worst(&actual, CoursePart::TcpBlend);
    assert!(off_mm < 2e-3, "{off_mm}");
}

/// A robot that blends the programmed distance on each side, or half of the line: the sides are not
/// equalised.
#[test]
fn unequal_blend_lengths_are_reported() {
    let robot = Robot::default();
    let trial = tcp_blends(&[TcpSeries::Shares]);
    let path = JointPath::new(&trial.program, &robot).unwrap();
    let mut q_rad = vec![*path.start_rad(); 200];
    let mut pose = robot.flange_pose(path.start_rad());
    let place = |mm: f64, angle_deg: f64| {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        [CORNER_M[0] + 1e-3 * mm * sin, CORNER_M[1] + 1e-3 * mm * cos, CORNER_M[2]]
    };
    let mut go = |to: [f64; 3], by: &dyn Fn(f64) -> [f64; 3], q_rad: &mut Vec<Joints>| {
        for i in 1..=600 {
            let t = f64::from(i) / 600.0;
            pose.position_m = by(t * t * t * (10.0 - t * (15.0 - 6.0 * t)));
            q_rad.push(joints(&robot, &pose));
        }
        pose.position_m = to;
        q_rad.extend(vec![joints(&robot, &pose); 100]);
    };
    let mut from = place(120.0, 180.0);
    for i in 1..=5 {
        let angle_deg = 30.0 * f64::from(i);
        for [into_mm, out_mm] in [[160.0, 70.0], [70.0, 160.0_f64]] {
            let start = place(into_mm, 180.0);
            let line = |s: f64| std::array::from_fn(|k| from[k] + s * (start[k] - from[k]));
            go(start, &line, &mut q_rad);
            let end = place(out_mm, angle_deg);
            // Independent reaches: 60 mm, but at most half of the line.
            let reach = [into_mm, out_mm].map(|way: f64| (0.5 * way).min(60.0));
            let kappa = robot.tcp_kappa(angle_deg);
            let whole = into_mm + out_mm;
            let about = |s: f64| {
                let way = s * whole;
                let (into, end_mm) = (into_mm - reach[0], whole - out_mm + reach[1]);
                if way < into {
                    place(into_mm - way, 180.0)
                } else if way > end_mm {
                    place(way - into_mm, angle_deg)
                } else {
                    let s = (way - into) / (end_mm - into);
                    let alpha = s * s * s * (10.0 - s * (15.0 - 6.0 * s));
                    let beta = -(s * (1.0 - s)).powi(3);
                    let (a, b) = ((1.0 - s) * reach[0], s * reach[1]);
                    let a: [f64; 3] = place(a, 180.0);
                    let b: [f64; 3] = place(b, angle_deg);
                    let [d0, d1] = [place(reach[0], 0.0), place(reach[1], angle_deg)];
                    std::array::from_fn(|k| {
                        (1.0 - alpha) * a[k] + alpha * b[k] - kappa * beta * (d1[k] - d0[k])
                    })
                }
            };
            go(end, &about, &mut q_rad);
            from = end;
        }
    }
    let t_s = (0..q_rad.len()).map(|i| i as f64 * 1e-3).collect();
    let actual = identified(&trial, &JointLog::new(t_s, q_rad), &robot);
    let share = actual.tcp_unequal_share.unwrap();
    assert!((share.value - 1.0).abs() < 1e-3 && share.count == 10, "{share:?}");
    for blend in &actual.tcp_blends {
        // kappa belongs to the observed reach, not to the assumed one.
        let (kappa, _) = blend.kappa;
        assert!((kappa - robot.tcp_kappa(blend.gamma_deg)).abs() < 1e-2, "{blend:?}");
        let [before, after] = blend.found_reach_m.unwrap();
        let [min_reach, max_reach] = [before.min(after), before.max(after)];
        assert!((min_reach - 0.035).abs() < 1e-5 && (max_reach - 0.06).abs() < 1e-5, "{blend:?}");
    }
}

/// A tool TCP: the corners are those of the tool.
#[test]
fn the_tools_tcp_counts() {
    let mut trial = tcp_blends(&[TcpSeries::Angles]);
    let tool = iiwa_program::Tool {
        tcp: iiwa_program::Frame { xyz_mm: [30.0, -20.0, 120.0], abc_rad: [0.3, 0.1, 0.0] },
        ..iiwa_program::Tool::default()
    };
    trial.program.workcell.tools.insert("gripper".to_owned(), tool);
    trial.program.workcell.tool = Some("gripper".to_owned());
    let model = Robot::lbr_iiwa_14_r820();
    let truth = any_robot(&model, &mut Rng::with_seed(5));
    let log = VirtualRobot::new(truth.clone(), 1).run(&trial.program).unwrap();
    let kappa = identified(&trial, &log, &model).tcp_kappa.unwrap();
    for gamma in angles() {
        assert!((kappa.at(gamma).value - truth.tcp_kappa(gamma)).abs() < 2e-3, "{gamma}");
    }
    // The tool centre point is away from the flange centre, so that the flange path has no such
    // corners.
    let point = apply(&truth.flange_pose(&log.q_rad[0]).rotation, &[0.03, -0.02, 0.12]);
    assert!(point.iter().any(|v| v.abs() > 0.1));
}
