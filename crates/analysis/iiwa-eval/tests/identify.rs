//! Identification of virtual robots with random limits and kappa from their recordings.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by it")]

use fastrand::Rng;
use iiwa_eval::{
    Estimate, VirtualRobot,
    experiment::{self, CycleTimeCase, Trial},
    identify::{Identified, IdentifyError, RecordedRun, Why, identify},
};
use iiwa_kin::{Joints, Robot};
use iiwa_log::JointLog;
use iiwa_path::{Continuity, JointPath, PolynomialBlend, Segment, Step};
use iiwa_program::{Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{SweepOptions, Timing, Trajectory};

/// Creates a robot whose limits are up to 25 % below and 30 % above the model's, and whose kappa
/// differs by up to 1.5 from the model's.
fn any_robot(random: &mut Rng) -> Robot {
    let mut limits = *Robot::default().limits();
    for j in 0..7 {
        let mut factor = || 0.75 + 0.55 * random.f64();
        limits.velocity_rad_s[j] *= factor();
        limits.acceleration_rad_s2[j] *= factor();
        limits.jerk_rad_s3[j] *= factor();
    }
    // kappa at 0, 90 and 180 deg.
    let [a, b, c] = [0.0, 90.0, 180.0]
        .map(|gamma_deg| Robot::default().kappa(gamma_deg) + 3.0 * (random.f64() - 0.5));
    let square = (a - 2.0 * b + c) / (2.0 * 90.0 * 90.0);
    Robot::default()
        .with_limits(limits)
        .with_blend_kappa([a, (b - a) / 90.0 - 90.0 * square, square])
        .with_settle_time_s(0.02 + 0.08 * random.f64())
}

/// Creates some of the experiments: limits from three poses and the wide swings, blends, settle
/// times.
fn trials(seed: u64) -> Vec<Trial> {
    let mut limits = experiment::limits();
    let wide = limits.pop().unwrap();
    limits.truncate(3);
    let settle = experiment::settle(&Robot::default(), 40, seed);
    limits.extend([wide, experiment::blends(0.5), settle]);
    limits
}

fn run(robot: &mut VirtualRobot, trials: &[Trial]) -> Vec<JointLog> {
    trials.iter().map(|trial| robot.run(&trial.program).unwrap()).collect()
}

fn identified(trials: &[Trial], logs: &[JointLog]) -> Identified {
    let recordings: Vec<_> = trials
        .iter()
        .zip(logs)
        .map(|(trial, log)| RecordedRun { program: &trial.program, log })
        .collect();
    identify(&recordings, &Robot::default()).unwrap()
}

/// Errors of one kind of estimate.
#[derive(Default)]
struct Errors {
    worst: f64,
    inside: usize,
    count: usize,
    /// Number of estimates whose uncertainty is at least their unit.
    vague: usize,
}

impl Errors {
    /// Adds an estimate with its error in units of `unit`.
    fn add(&mut self, estimate: Estimate, truth: f64, unit: f64) {
        if estimate.uncertainty < unit {
            self.worst = self.worst.max(((estimate.value - truth) / unit).abs());
        } else {
            self.vague += 1;
        }
        self.inside += usize::from(estimate.holds(truth));
        self.count += 1;
    }

    fn share(&self) -> f64 {
        self.inside as f64 / self.count as f64
    }
}

/// Adds the errors of speed, acceleration and jerk as shares, of the settle time in s, and of
/// kappa.
fn errors(identified: &Identified, truth: &Robot, errors: &mut [Errors; 5]) {
    let limits = truth.limits();
    let kinds = [
        (&identified.velocity_rad_s, &limits.velocity_rad_s),
        (&identified.acceleration_rad_s2, &limits.acceleration_rad_s2),
        (&identified.jerk_rad_s3, &limits.jerk_rad_s3),
    ];
    for (errors, (identified, truth)) in errors.iter_mut().zip(kinds) {
        for (identified, truth) in identified.iter().zip(truth) {
            errors.add(identified.expect("a joint's limit is shown"), *truth, *truth);
        }
    }
    errors[3].add(identified.settle.unwrap().mean_s, truth.settle_time_s(), 1.0);
    let kappa = identified.kappa.unwrap();
    for i in 1..=17 {
        let gamma_deg = f64::from(i) * 10.0;
        errors[4].add(kappa.at(gamma_deg), truth.kappa(gamma_deg), 1.0);
    }
}

/// Returns `long` seeds with `IIWASIM_LONG=1`, else `short`: a robot takes most of a second.
fn robots(short: u64, long: u64) -> std::ops::Range<u64> {
    0..if std::env::var_os("IIWASIM_LONG").is_some() { long } else { short }
}

#[test]
fn random_robots_are_found() {
    let mut random = Rng::with_seed(1);
    let mut all: [Errors; 5] = Default::default();
    for seed in robots(8, 50) {
        let truth = any_robot(&mut random);
        let mut robot = VirtualRobot::new(truth.clone(), seed);
        robot.noise_rad = 1e-5;
        let trials = trials(seed);
        let logs = run(&mut robot, &trials);
        let actual = identified(&trials, &logs);
        assert_eq!(actual.left_out, []);
        // Algorithm 3: blends begin and end at equal distances.
        let unequal = actual.unequal_share.unwrap();
        assert!(unequal.value.abs() < 1e-3 && unequal.count > 30, "{unequal:?}");
        errors(&actual, &truth, &mut all);
    }
    println!("| figure | required | worst error | inside the uncertainty |\n|---|---|---|---|");
    for ((quantity, max_error), errors) in [
        ("velocity", 0.005),
        ("acceleration", 0.02),
        ("jerk", 0.1),
        ("settle, s", 0.002),
        ("kappa, 10 to 170 deg", 0.15),
    ]
    .into_iter()
    .zip(all)
    {
        let Errors { worst, inside, count, vague } = errors;
        println!("| {quantity} | {max_error} | {worst:.2e} | {inside} of {count} |");
        assert_eq!(vague, 0, "{quantity}");
        assert!(worst <= max_error, "{quantity}: {worst}");
        assert!(errors.share() >= 0.9, "{quantity}: {inside} of {count}");
    }
}

/// Ten times the noise, or a fifth of the samples: results are still found, with correct
/// uncertainties.
#[test]
fn noise_and_few_samples() {
    for (noise_rad, period_s) in [(1e-4, 1e-3), (1e-5, 5e-3)] {
        let mut random = Rng::with_seed(2);
        let mut all: [Errors; 5] = Default::default();
        for seed in robots(3, 10) {
            let truth = any_robot(&mut random);
            let mut robot = VirtualRobot::new(truth.clone(), seed);
            (robot.noise_rad, robot.period_s) = (noise_rad, period_s);
            let trials = trials(seed);
            let logs = run(&mut robot, &trials);
            errors(&identified(&trials, &logs), &truth, &mut all);
        }
        for (errors, max_error) in all.iter().zip([0.005, 0.02, 0.1, 0.002, 0.15]) {
            println!("{noise_rad} {period_s}: {:.2e}, {:.2}", errors.worst, errors.share());
            assert!(errors.worst <= max_error && errors.share() >= 0.85 && errors.vague == 0);
        }
    }
}

/// Properties of real recordings: positions in steps of 0.01 deg, inaccurate times, other noise.
/// Some residuals are correlated, which the uncertainties account for.
#[test]
fn recordings_that_are_not_ideal() {
    type Distort = fn(&mut f64, &mut Joints, &mut Rng);
    let kinds: [(&str, Distort); 3] = [
        ("steps", |_, q, _| *q = q.map(|q| (q / STEP_RAD).round() * STEP_RAD)),
        ("stamps", |t_s, _, random| *t_s += 3e-4 * (random.f64() - 0.5)),
        ("noise", |_, q, random| *q = q.map(|q| q + 1e-3 * (random.f64() - 0.5))),
    ];
    for (name, distort) in kinds {
        let mut random = Rng::with_seed(4);
        let mut all: [Errors; 5] = Default::default();
        // Twelve robots, since the share is close to its bound.
        for seed in 0..12 {
            let truth = any_robot(&mut random);
            let mut robot = VirtualRobot::new(truth.clone(), seed);
            robot.noise_rad = 1e-5;
            let trials = trials(seed);
            let mut logs = run(&mut robot, &trials);
            for log in &mut logs {
                for (t_s, q_rad) in log.t_s.iter_mut().zip(&mut log.q_rad) {
                    distort(t_s, q_rad, &mut random);
                }
            }
            errors(&identified(&trials, &logs), &truth, &mut all);
        }
        for (errors, max_error) in all.iter().zip([0.1, 0.1, 0.3, 0.002, 0.15]) {
            println!("{name}: {:.2e}, {:.2}", errors.worst, errors.share());
            // Barely visible limits have large uncertainties, such as that of a speed that was kept
            // for some ms.
            assert!(errors.worst <= max_error && errors.vague <= 1, "{name}: {}", errors.vague);
        }
        let inside: usize = all.iter().map(|errors| errors.inside).sum();
        let count: usize = all.iter().map(|errors| errors.count).sum();
        assert!(inside as f64 >= 0.85 * count as f64, "{name}: {inside} of {count}");
    }
}

/// A hundredth of a degree.
const STEP_RAD: f64 = 1.745e-4;

/// Cycle times and paths of programs that were not used for the identification.
#[test]
fn unseen_programs_take_the_predicted_time() {
    let mut random = Rng::with_seed(3);
    let (mut worst_time, mut worst_path) = (0.0_f64, 0.0_f64);
    for seed in robots(3, 10) {
        let truth = any_robot(&mut random);
        let mut robot = VirtualRobot::new(truth.clone(), seed);
        robot.noise_rad = 1e-5;
        let trials = trials(seed);
        let logs = run(&mut robot, &trials);
        let actual = identified(&trials, &logs).robot(&Robot::default());
        let cases = [
            (1.0, 0.25, 100.0),
            (0.3, 0.5, 50.0),
            (0.6, 0.0, 150.0),
            (0.8, 0.4, 25.0),
            (0.1, 0.1, 80.0),
        ];
        for (path, (velocity_rel, blend, length_deg)) in (0..).zip(cases) {
            let case = CycleTimeCase { path, velocity_rel, blend, length_deg };
            let program = case.trial(&Robot::default(), 100 + seed).program;
            let [predicted, happened] =
                [&actual, &truth].map(|robot| JointPath::new(&program, robot).unwrap());
            for (predicted, happened) in predicted.steps().iter().zip(happened.steps()) {
                let (Step::Move { segment: a, .. }, Step::Move { segment: b, .. }) =
                    (predicted, happened)
                else {
                    continue;
                };
                for i in 0..=50 {
                    let s = f64::from(i) / 50.0;
                    let [a, b] = [a, b].map(|segment| truth.flange_position(&segment.at(s).q));
                    let off = (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2]);
                    worst_path = worst_path.max(off);
                }
            }
            let [predicted, happened] = [predicted, happened].map(|path| {
                Trajectory::plan(&path, Timing::jerk_limited()).unwrap().cycle_time_s()
            });
            worst_time = worst_time.max((predicted / happened - 1.0).abs());
        }
    }
    println!("cycle time {worst_time:.2e}, path {worst_path:.2e} m");
    assert!(worst_time <= 0.005, "{worst_time}");
    assert!(worst_path <= 1e-3, "{worst_path}");
}

fn ptp(joints_deg: Joints) -> Ptp {
    Ptp::to(joints_deg.map(f64::to_radians))
}

fn program(motions: impl IntoIterator<Item = Ptp>) -> Program {
    Program {
        robot: None,
        start: Start::Joints([0.0; 7]),
        motions: motions.into_iter().map(Motion::Ptp).collect(),
        workcell: Workcell::default(),
        sources: Sources::default(),
    }
}

fn identified_from(program: &Program) -> Identified {
    let log = VirtualRobot::new(Robot::default(), 1).run(program).unwrap();
    identify(&[RecordedRun { program, log: &log }], &Robot::default()).unwrap()
}

#[test]
fn nothing_is_identified_that_is_not_shown() {
    // Joint 1 reaches full speed; joint 6 does not within 20 deg. The others do not move.
    let swing = program([
        ptp([60.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        ptp([60.0, 0.0, 0.0, 0.0, 0.0, 20.0, 0.0]),
    ]);
    let actual = identified_from(&swing);
    let shown = |list: &[Option<Estimate>; 7]| list.map(|actual| actual.is_some());
    assert_eq!(shown(&actual.velocity_rad_s), [true, false, false, false, false, false, false]);
    for limits in [&actual.acceleration_rad_s2, &actual.jerk_rad_s3] {
        assert_eq!(shown(limits), [true, false, false, false, false, true, false]);
    }
    assert_eq!(actual.settle.unwrap().mean_s.count, 1);
    assert!(actual.kappa.is_none() && actual.unequal_share.is_none());
    // Values that were not identified remain those of the model.
    let robot = actual.robot(&Robot::default());
    let model = Robot::default();
    assert_eq!(robot.blend_kappa(), model.blend_kappa());
    assert_eq!(robot.limits().velocity_rad_s[1..], model.limits().velocity_rad_s[1..]);
    // They are listed as assumptions, with the source of their values.
    for quantity in [
        "velocity of A2, A3, A4, A5, A6, A7",
        "acceleration of A2, A3, A4, A5, A7",
        "jerk of A2, A3, A4, A5, A7",
        "ramps of all joints",
        "blend curve",
        "friction",
    ] {
        assert!(robot.assumes(quantity), "{quantity}: {:?}", robot.assumptions());
    }
    assert!(!robot.assumes("settling time"));
    assert!(robot.assumptions().last().unwrap().basis.ends_with("; taken from lbr_iiwa_7_r800"));
    // The profile is the same as without them.
    let read_back = Robot::from_profile(&robot.to_profile()).unwrap();
    assert_eq!(read_back.limits(), robot.limits());

    // One corner has one angle, which does not determine a polynomial.
    let mut corner = ptp([60.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    corner.blend = Some(iiwa_program::Blend::Fraction(0.25));
    let actual = identified_from(&program([corner, ptp([60.0, 40.0, 0.0, 0.0, 0.0, 0.0, 0.0])]));
    assert_eq!(actual.blends.len(), 1);
    assert!((actual.blends[0].kappa.0 - model.kappa(90.0)).abs() < 1e-3);
    assert!(actual.kappa.is_none());
}

/// A robot without jerk limits shows none.
#[test]
fn jerk_that_does_not_show() {
    let swing = program([ptp([60.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])]);
    let path = JointPath::new(&swing, &Robot::default()).unwrap();
    let plan = Trajectory::plan(&path, Timing::Acceleration(SweepOptions::default())).unwrap();
    let t_s: Vec<f64> = (0..1500).map(|i| f64::from(i) * 1e-3).collect();
    let q_rad = t_s.iter().map(|t_s| plan.at(t_s - 0.2).q).collect();
    let log = JointLog::new(t_s, q_rad);
    let recording = RecordedRun { program: &swing, log: &log };
    let actual = identify(&[recording], &Robot::default()).unwrap();
    assert_eq!(actual.jerk_rad_s3, [None; 7]);
    let acceleration = actual.acceleration_rad_s2[0].unwrap().value.to_degrees();
    assert!((acceleration / 490.0 - 1.0).abs() < 1e-3, "{acceleration}");
}

/// A program that is repeated yields as many observations.
#[test]
fn every_run_counts() {
    let swing = program([ptp([60.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), ptp([0.0; 7])]);
    let once = VirtualRobot::new(Robot::default(), 1).run(&swing).unwrap();
    let whole_s = once.duration_s() + 1e-3;
    let t_s = (0..3).flat_map(|run| once.t_s.iter().map(move |t_s| t_s + f64::from(run) * whole_s));
    let q_rad = once.q_rad.repeat(3);
    let log = JointLog::new(t_s.collect(), q_rad);
    let recording = RecordedRun { program: &swing, log: &log };
    let actual = identify(&[recording], &Robot::default()).unwrap();
    assert_eq!(actual.velocity_rad_s[0].unwrap().count, 6);
    assert_eq!(actual.settle.unwrap().mean_s.count, 3);
}

#[test]
fn another_program_is_refused() {
    let far = program([ptp([60.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])]);
    let log = VirtualRobot::new(Robot::default(), 1).run(&far).unwrap();
    let mut elsewhere = far.clone();
    elsewhere.start = Start::Joints([0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let recording = RecordedRun { program: &elsewhere, log: &log };
    let error = identify(&[recording], &Robot::default()).unwrap_err();
    assert!(matches!(error, IdentifyError::NotThere { .. }), "{error}");

    let other = program([ptp([0.0, 60.0, 0.0, 0.0, 0.0, 0.0, 0.0])]);
    let recording = RecordedRun { program: &other, log: &log };
    let error = identify(&[recording], &Robot::default()).unwrap_err();
    assert!(matches!(error, IdentifyError::NoMotion { .. }), "{error}");

    // Identified up to the end of the recording.
    let mut longer = far.clone();
    longer.motions.push(Motion::Ptp(ptp([60.0, 60.0, 0.0, 0.0, 0.0, 0.0, 0.0])));
    let recording = RecordedRun { program: &longer, log: &log };
    let actual = identify(&[recording], &Robot::default()).unwrap();
    assert!(actual.velocity_rad_s[0].is_some());
    assert_eq!((actual.left_out[0].motion.index(), actual.left_out[0].why), (1, Why::NotFollowed));
}

/// A spline that ends at its start leads away in between.
#[test]
fn closed_programs_are_followed() {
    let robot = Robot::default();
    let start = [0.0_f64, 30.0, 0.0, -60.0, 0.0, 90.0, 0.0];
    let pose = robot.flange_pose(&start.map(f64::to_radians));
    let [x, y, z] = pose.position_m.map(|m| 1e3 * m);
    let [a, b, c] = pose.abc_rad().map(f64::to_degrees);
    let at = |dx: f64, dy: f64| {
        let (x, y) = (x + dx, y + dy);
        format!(
            r#"{{ "type": "spl", "frame": {{ "x_mm": {x}, "y_mm": {y}, "z_mm": {z},
                "a_deg": {a}, "b_deg": {b}, "c_deg": {c} }} }}"#
        )
    };
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": {start:?} }}, "motions": [
            {{ "type": "spline", "segments": [{}, {}, {}] }},
            {{ "type": "ptp", "joints_deg": [60, 30, 0, -60, 0, 90, 0] }}
        ] }}"#,
        at(80.0, 40.0),
        at(80.0, -40.0),
        at(0.0, 0.0)
    );
    let actual = identified_from(&Program::from_json(&text).unwrap());
    let lost = actual.left_out.iter().filter(|it| it.why == Why::NotFollowed).count();
    assert_eq!(lost, 0, "{:?}", actual.left_out);
    assert!(actual.velocity_rad_s[0].is_some());
}

/// Joint 2 of the recording is the program's joint 4: nothing is identified beyond the point where
/// they differ.
#[test]
fn motions_off_the_path_are_left_out() {
    let swing = |joint: usize| ptp(std::array::from_fn(|j| if j == joint { 60.0 } else { 0.0 }));
    let home = || ptp([0.0; 7]);
    let ran = program([swing(0), home(), swing(3), home(), swing(1), home()]);
    let other_program = program([swing(0), home(), swing(1), home(), swing(3), home()]);
    let log = VirtualRobot::new(Robot::default(), 1).run(&ran).unwrap();
    let recording = RecordedRun { program: &other_program, log: &log };
    let actual = identify(&[recording], &Robot::default()).unwrap();
    let shown = actual.velocity_rad_s.map(|limit| limit.is_some());
    assert_eq!(shown, [true, false, false, false, false, false, false]);
    let last = actual.left_out.last().unwrap();
    assert_eq!((last.motion.index(), last.why), (2, Why::NotFollowed));
}

/// Noise may hide a phase of a motion. The results then have a large uncertainty.
#[test]
fn figures_hidden_by_noise_are_uncertain() {
    let swing = |by_deg: f64| ptp([0.0, by_deg, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let swings = program((0..10).flat_map(|_| [swing(40.0), swing(0.0)]));
    let limits = *Robot::default().limits();
    for noise_rad in [1e-4, 5e-4, 1e-3] {
        let mut robot = VirtualRobot::new(Robot::default(), 1);
        robot.noise_rad = noise_rad;
        let log = robot.run(&swings).unwrap();
        let actual =
            identify(&[RecordedRun { program: &swings, log: &log }], &Robot::default()).unwrap();
        for (actual, truth) in [
            (actual.velocity_rad_s[1], limits.velocity_rad_s[1]),
            (actual.acceleration_rad_s2[1], limits.acceleration_rad_s2[1]),
            (actual.jerk_rad_s3[1], limits.jerk_rad_s3[1]),
        ] {
            // Twice the half-width of the 95 % confidence interval.
            assert!(
                actual.is_none_or(|actual| (actual.value - truth).abs() < 2.0 * actual.uncertainty),
                "{noise_rad}: {actual:?}, {truth}"
            );
        }
    }
}

/// A robot that creeps to its target unlike a controlled motion.
#[test]
fn other_motions_are_left_out() {
    let swing = program([ptp([60.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])]);
    let t_s: Vec<f64> = (0..6000).map(|i| f64::from(i) * 1e-3).collect();
    let q_rad = t_s
        .iter()
        .map(|t_s| {
            let t = (t_s - 1.0).max(0.0);
            let way = 1.0 - (-t * 2.0).exp() * (1.0 + 2.0 * t) * (1.0 + 0.3 * (9.0 * t).sin());
            [60_f64.to_radians() * way, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        })
        .collect();
    let log = JointLog::new(t_s, q_rad);
    let recording = RecordedRun { program: &swing, log: &log };
    let actual = identify(&[recording], &Robot::default()).unwrap();
    assert_eq!(actual.velocity_rad_s, [None; 7]);
    assert!(matches!(actual.left_out[0].why, Why::NoLine(_)), "{:?}", actual.left_out);
}

/// A robot that blends a quarter of each motion, of any length: without Algorithm 3.
#[test]
fn blends_that_begin_and_end_at_other_distances() {
    let corner = [0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let end = [0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let to_corner = Ptp::to(corner).blend(iiwa_program::Blend::Fraction(0.25));
    let turn = program([to_corner, Ptp::to(end)]);
    let kappa = Robot::default().kappa(90.0);
    let scaled = |v: &Joints, k: f64| v.map(|v| k * v);
    let (d0, d1) = ([0.125, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.25, 0.0, 0.0, 0.0]);
    let blend = PolynomialBlend::new(&corner, d0, &d1, kappa, Continuity::Second);
    let t_s: Vec<f64> = (0..3000).map(|i| f64::from(i) * 1e-3).collect();
    let at = |t_s: f64| {
        // From 0 to 3 within two seconds: a line, the blend, a line.
        let t = ((t_s - 0.5) / 2.0).clamp(0.0, 1.0);
        let way = 3.0 * t * t * t * (10.0 - t * (15.0 - 6.0 * t));
        match way {
            ..1.0 => scaled(&[0.375, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], way),
            ..2.0 => blend.at(way - 1.0).q,
            _ => {
                let beyond = 0.25 + 0.75 * (way - 2.0);
                [0.5, 0.0, 0.0, beyond, 0.0, 0.0, 0.0]
            }
        }
    };
    let q_rad = t_s.iter().map(|t_s| at(*t_s)).collect();
    let log = JointLog::new(t_s, q_rad);
    let recording = RecordedRun { program: &turn, log: &log };
    let actual = identify(&[recording], &Robot::default()).unwrap();
    let unequal = actual.unequal_share.unwrap();
    assert!((unequal.value - 1.0).abs() < 1e-3, "{unequal:?} {:?}", actual.blends);
    let [before, after] = actual.blends[0].found_reach_rad.unwrap();
    assert!((before - 0.125).abs() < 1e-4 && (after - 0.25).abs() < 1e-4);
}

/// Motions before the start and after the end do not belong to the program.
#[test]
fn motions_before_and_after_do_not_blur_the_program() {
    let transfers = program([
        ptp([0.0, 30.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        ptp([0.0; 7]),
        ptp([60.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        ptp([60.0, 0.0, 0.0, 30.0, 0.0, 0.0, 0.0]),
    ]);
    let mut log = VirtualRobot::new(Robot::default(), 1).run(&transfers).unwrap();
    // The recording begins on the way to the program's start, which resembles one of its motions.
    let from = log.q_rad.iter().position(|q| q[1] > 0.5).unwrap();
    log.t_s.drain(..from);
    log.q_rad.drain(..from);
    let swing = program([ptp([60.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])]);
    let recording = RecordedRun { program: &swing, log: &log };
    let actual = identify(&[recording], &Robot::default()).unwrap();
    assert_eq!(actual.left_out, []);
    let velocity = actual.velocity_rad_s[0].unwrap().value.to_degrees();
    let acceleration = actual.acceleration_rad_s2[0].unwrap().value.to_degrees();
    assert!((velocity / 98.0 - 1.0).abs() < 1e-6, "{velocity}");
    assert!((acceleration / 490.0 - 1.0).abs() < 1e-5, "{acceleration}");
}
