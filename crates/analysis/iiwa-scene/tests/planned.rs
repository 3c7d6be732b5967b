//! Clearances of planned motions, compared with individual poses.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iiwa_kin::Robot;
use iiwa_path::{BlendShape, Continuity, JointPath, PathOptions};
use iiwa_program::{Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_scene::{ArmInScene, Form, Obstacle, Scene, TriangleSurface};
use iiwa_traj::{SweepOptions, Timing, Trajectory};
use iiwasim_tests::{fixture, random::programs};
use proptest::prelude::*;

const TOLERANCE_M: f64 = 1e-4;

fn plan(program: &Program, options: PathOptions, timing: Timing) -> Trajectory {
    let path = JointPath::with_options(program, &Robot::default(), options).unwrap();
    Trajectory::plan(&path, timing).unwrap()
}

/// Creates a LIN that moves the wrist past a post: at both ends the arm is clear, but not in
/// between.
#[test]
fn a_line_of_the_tcp_passes_an_obstacle() {
    let text = r#"{
        "version": 1,
        "start": { "joints_deg": [-35, 45, 0, -75, 0, 60, 0] },
        "motions": [{ "type": "lin_rel", "offset": { "y_mm": 600 }, "in":
            { "x_mm": 0, "y_mm": 0, "z_mm": 0, "a_deg": 0, "b_deg": 0, "c_deg": 0 } }]
    }"#;
    let program = Program::from_json(text).unwrap();
    for timing in [acceleration(), Timing::default()] {
        let plan = plan(&program, PathOptions::default(), timing);
        let middle = plan.at(0.5 * plan.cycle_time_s());
        let [x, y, z] = Robot::default().flange_position(&middle.q);
        for gap_m in [0.02, 0.05, -0.05] {
            let center_m = [x, y, z - 0.15 - 0.1 - gap_m];
            let form = Form::Box { center_m, size_m: [0.05, 0.05, 0.3], rpy_rad: [0.0; 3] };
            let post = Obstacle { name: "post".to_owned(), form };
            let arm = ArmInScene::new(&Robot::default(), &Scene::new(vec![post]).unwrap());
            check(&arm, &plan, 2000);
            let actual = arm.clearance_of(&plan).unwrap();
            let ends_m = [0.0, plan.cycle_time_s()]
                .map(|t_s| arm.clearance(&plan.at(t_s).q).unwrap().distance_m);
            // The arm is nearest during the motion.
            assert!(ends_m.iter().all(|end_m| *end_m > actual.clearance.distance_m + 0.05));
            assert!(actual.at_s > 0.0 && actual.at_s < plan.cycle_time_s());
        }
    }
}

fn acceleration() -> Timing {
    Timing::Acceleration(SweepOptions::default())
}

/// Checks that the result is that of a pose, and that no sample is nearer by more than the
/// tolerance.
fn check(arm: &ArmInScene, trajectory: &Trajectory, samples: u32) {
    let actual = arm.clearance_of(trajectory).unwrap();
    let distance_m = actual.clearance.distance_m;
    let at_time = arm.clearance(&trajectory.at(actual.at_s).q).unwrap();
    // Near a rest, the last digit of a time corresponds to a large range of s: the pose is not
    // exactly that of the result.
    assert!((at_time.distance_m - distance_m).abs() < 1e-5, "{at_time:?}, {actual:?}");
    let end_s = trajectory.cycle_time_s();
    let at = |i: u32| end_s * f64::from(i) / f64::from(samples);
    for t_s in (0..=samples).map(at) {
        let sample = arm.clearance(&trajectory.at(t_s).q).unwrap();
        assert!(sample.distance_m > distance_m - TOLERANCE_M, "{t_s} s: {sample:?}, {actual:?}");
        if distance_m == 0.0 && t_s < actual.at_s - 1e-3 {
            assert!(
                sample.distance_m > 0.0 || touches_by_less(arm, trajectory, t_s),
                "{t_s} s, {actual:?}"
            );
        }
    }
    // Results of the individual motions.
    let each: Vec<_> = trajectory.sections().iter().flat_map(|s| arm.clearances(s)).collect();
    assert_eq!(each.len(), trajectory.motions().len());
    let min_m = each.iter().map(|c| c.clearance.distance_m).fold(f64::MAX, f64::min);
    assert!((min_m - distance_m).abs() < TOLERANCE_M);
    for (motion, figures) in each.iter().zip(trajectory.motions()) {
        assert_eq!(motion.motion, figures.motion);
        let standing_s = 1e-9 + if figures.end_s < end_s { end_s } else { 1.0 };
        assert!((figures.start_s - 1e-9..figures.end_s + standing_s).contains(&motion.at_s));
    }
}

/// Returns true if the arm would be free with all obstacles smaller by twice the tolerance.
fn touches_by_less(arm: &ArmInScene, trajectory: &Trajectory, t_s: f64) -> bool {
    let smaller = arm.scene().obstacles().iter().map(|obstacle| {
        let smaller = 2.0 * TOLERANCE_M;
        let form = match obstacle.form {
            Form::Box { center_m, size_m, rpy_rad } => {
                Form::Box { center_m, size_m: size_m.map(|m| m - 4.0 * TOLERANCE_M), rpy_rad }
            }
            Form::Plane { point_m, normal } => {
                let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
                let back = 2.0 * TOLERANCE_M / length;
                let point_m = std::array::from_fn(|i| point_m[i] - back * normal[i]);
                Form::Plane { point_m, normal }
            }
            Form::Cylinder { center_m, radius_m, length_m, rpy_rad } => Form::Cylinder {
                center_m,
                radius_m: radius_m - smaller,
                length_m: length_m - 2.0 * smaller,
                rpy_rad,
            },
            Form::Sphere { center_m, radius_m } => {
                Form::Sphere { center_m, radius_m: radius_m - smaller }
            }
            // Smaller in each direction, because all points are at least a centimetre away from the
            // planes through the centre of the mesh.
            Form::Mesh { ref surface, origin_m, rpy_rad } => {
                let scale = 1.0 - 100.0 * smaller;
                let points = surface.points_m().iter().map(|point| point.map(|v| v * scale));
                let surface = TriangleSurface::new(points, surface.triangles().to_vec()).unwrap();
                Form::Mesh { surface, origin_m, rpy_rad }
            }
            _ => unreachable!("there are no others"),
        };
        Obstacle { name: obstacle.name.clone(), form }
    });
    let smaller = Scene::new(smaller.collect()).unwrap();
    let arm = ArmInScene::new(&Robot::default(), &smaller);
    arm.clearance(&trajectory.at(t_s).q).unwrap().distance_m > 0.0
}

fn cases() -> u32 {
    if std::env::var_os("IIWASIM_LONG").is_some() { 1000 } else { 80 }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases()))]

    #[test]
    fn no_sample_is_nearer(program in programs(4), seed in any::<u64>(), jerk in 0..4) {
        let scene = crate::common::scene(&mut fastrand::Rng::with_seed(seed), 4);
        let arm = ArmInScene::new(&Robot::default(), &scene);
        let timing = if jerk == 0 { Timing::default() } else { acceleration() };
        check(&arm, &plan(&program, PathOptions::default(), timing), 3000);
    }

    #[test]
    fn nor_on_other_blends(program in programs(3), seed in any::<u64>(), shape in 0..3) {
        let blend_shape = match shape {
            0 => BlendShape::Circle,
            1 => BlendShape::Alpha(Continuity::Third),
            _ => BlendShape::MinAcceleration,
        };
        let options = PathOptions { blend_shape, ..PathOptions::default() };
        prop_assume!(JointPath::with_options(&program, &Robot::default(), options).is_ok());
        let scene = crate::common::scene(&mut fastrand::Rng::with_seed(seed), 3);
        let arm = ArmInScene::new(&Robot::default(), &scene);
        check(&arm, &plan(&program, options, acceleration()), 2000);
    }
}

/// A random case in which projections onto both solids do not converge at a distance of 11 um, just
/// before the arm touches the obstacle.
#[test]
fn the_contact_is_where_solids_touch() {
    let start_rad = [
        -1.187_472_588_273_584,
        0.825_521_845_907_537_5,
        -0.970_810_849_796_565_8,
        -1.089_982_290_751_218_2,
        0.204_753_334_992_692_33,
        -0.418_532_067_233_924_7,
        0.0,
    ];
    let target_rad = [
        -1.352_749_476_708_785_5,
        1.059_581_061_899_172_1,
        -1.092_066_658_228_348_7,
        -1.125_723_525_551_666_9,
        0.475_280_506_249_487_37,
        -0.555_886_309_853_661_4,
        0.0,
    ];
    let ptp = Ptp { acceleration_rel: [0.697_157_925_205_918; 7], ..Ptp::to(target_rad) };
    let program = Program {
        robot: None,
        start: Start::Joints(start_rad),
        motions: vec![
            Motion::Wait { seconds: 1.739_550_172_170_325_7, overlap: 0 },
            Motion::Ptp(ptp),
        ],
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let scene = crate::common::scene(&mut fastrand::Rng::with_seed(1_907_019_608_846_403_796), 3);
    let arm = ArmInScene::new(&Robot::default(), &scene);
    let trajectory = plan(&program, PathOptions::default(), acceleration());
    check(&arm, &trajectory, 2000);
    assert!(arm.clearance_of(&trajectory).unwrap().clearance.distance_m == 0.0);
}

#[test]
fn ten_motions_in_the_cage() {
    let read = |name| std::fs::read_to_string(fixture(name)).unwrap();
    let scene = Scene::from_json(&read("cage.json")).unwrap();
    let program = Program::from_json(&read("ten-motions.json")).unwrap();
    let arm = ArmInScene::new(&Robot::default(), &scene);
    let trajectory = plan(&program, PathOptions::default(), Timing::default());
    check(&arm, &trajectory, 100_000);
    let actual = arm.clearance_of(&trajectory).unwrap();
    println!("{actual:?}");
    assert!(actual.clearance.distance_m > 0.01);
}

/// The arm keeps a constant distance: no span is nearer than any other.
#[test]
fn an_arm_that_turns_over_a_table_keeps_its_distance() {
    let q = |q1| [q1, 1.2, 0.0, -1.2, 0.0, 0.6, 0.0];
    let program = Program {
        robot: None,
        start: Start::Joints(q(-2.0)),
        motions: vec![Motion::Ptp(Ptp::to(q(2.0)))],
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let table = Form::Plane { point_m: [0.0, 0.0, -0.01], normal: [0.0, 0.0, 1.0] };
    let scene = Scene::new(vec![Obstacle { name: "table".to_owned(), form: table }]).unwrap();
    let arm = ArmInScene::new(&Robot::default(), &scene);
    let trajectory = plan(&program, PathOptions::default(), Timing::default());
    let actual = arm.clearance_of(&trajectory).unwrap();
    let at_start = arm.clearance(program.start.joints_rad().unwrap()).unwrap();
    assert!((actual.clearance.distance_m - at_start.distance_m).abs() < 1e-12);
}

#[test]
fn the_first_contact_is_reported() {
    let program = Program {
        robot: None,
        start: Start::Joints([0.0, 0.5, 0.0, -1.0, 0.0, 0.5, 0.0]),
        motions: vec![
            Motion::Ptp(Ptp::to([0.0, 1.5, 0.0, -1.0, 0.0, 0.5, 0.0])),
            Motion::Wait { seconds: 2.0, overlap: 0 },
            Motion::Ptp(Ptp::to([0.0, 1.7, 0.0, -1.0, 0.0, 0.5, 0.0])),
        ],
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let table = Form::Plane { point_m: [0.0, 0.0, 0.2], normal: [0.0, 0.0, 1.0] };
    let scene = Scene::new(vec![Obstacle { name: "table".to_owned(), form: table }]).unwrap();
    let arm = ArmInScene::new(&Robot::default(), &scene);
    let trajectory = plan(&program, PathOptions::default(), Timing::default());
    let actual = arm.clearance_of(&trajectory).unwrap();
    assert_eq!((actual.clearance.distance_m, actual.motion.index()), (0.0, 0));
    let just_before = arm.clearance(&trajectory.at(actual.at_s - 1e-3).q).unwrap();
    assert!(just_before.distance_m > 0.0 && just_before.distance_m < 5e-3);
}

/// The arm is nearest at its final rest: the reported time is that of the arrival, for any rounding
/// of later samples.
#[test]
fn the_first_of_equal_instants_is_reported() {
    let wall = Form::Plane { point_m: [1.2, 0.3, 0.0], normal: [-1.0, -0.1, 0.02] };
    let scene = Scene::new(vec![Obstacle { name: "wall".to_owned(), form: wall }]).unwrap();
    let arm = ArmInScene::new(&Robot::default(), &scene);
    let text = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, -60, 0, 60, 0] }, "motions": [
        { "type": "ptp", "joints_deg": [13, 61, 7, -31, 5, 50, 0] },
        { "type": "wait", "seconds": 1 },
        { "type": "ptp", "joints_deg": [13, 61, 7, -31, 5, 50, 0] },
        { "type": "wait", "seconds": 1 },
        { "type": "ptp", "joints_deg": [0, 0, 0, -60, 0, 60, 0] } ] }"#;
    let program = Program::from_json(text).unwrap();
    let trajectory = plan(&program, PathOptions::default(), Timing::default());
    let arrival_s = trajectory.sections()[0].pieces()[0].end_s;
    let actual = arm.clearance_of(&trajectory).unwrap();
    assert!(actual.clearance.distance_m > 0.0);
    assert!(
        (arrival_s - 0.01..=arrival_s + 1e-6).contains(&actual.at_s),
        "{arrival_s} {}",
        actual.at_s
    );
}

#[test]
fn nothing_to_touch_is_no_clearance() {
    let scene = Scene::new(Vec::new()).unwrap();
    let arm = ArmInScene::new(&Robot::default(), &scene);
    assert_eq!(arm.clearance(&[0.0; 7]), None);
    let program = Program {
        robot: None,
        start: Start::Joints([0.0; 7]),
        motions: vec![Motion::Wait { seconds: 1.0, overlap: 0 }],
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let waiting = plan(&program, PathOptions::default(), Timing::default());
    assert_eq!(arm.clearance_of(&waiting), None);
    // A program of waits only has a clearance, too.
    let floor = Form::Plane { point_m: [0.0; 3], normal: [0.0, 0.0, 1.0] };
    let scene = Scene::new(vec![Obstacle { name: "floor".to_owned(), form: floor }]).unwrap();
    let arm = ArmInScene::new(&Robot::default(), &scene);
    let actual = arm.clearance_of(&waiting).unwrap();
    assert_eq!(Some(actual.clearance), arm.clearance(&[0.0; 7]));
    assert_eq!(arm.clearance(&[f64::NAN; 7]), None);
}
