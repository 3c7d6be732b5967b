//! Torque limits: compared with the plans of an independent solver, at every millisecond, and where
//! they are inactive.

use std::collections::BTreeMap;

use iiwa_kin::{Friction, Joint, Joints, Load, Mount, RigidBody, Robot};
use iiwa_path::{JointPath, PathOptions};
use iiwa_program::{Blend, Motion, MotionIndex, Program, ProgramError};
use iiwa_traj::{
    JerkOptions, Limit, PlanError, Replanner, SweepOptions, Timing, TimingError, Trajectory,
};
use iiwasim_tests::{
    loaded_programs::{LoadedProgram, loaded_program},
    tolerances,
    torque_reference::cases,
};

const TIMINGS: [fn() -> Timing; 2] =
    [Timing::jerk_limited, || Timing::Acceleration(SweepOptions::default())];

/// Tolerance of torque ratios in a plan.
const MAX_TORQUE: f64 = 1.01;

/// Returns the largest ratios of a trajectory at 1 kHz: of joint torques, velocity, acceleration
/// and jerk.
fn worst(trajectory: &Trajectory, limits_nm: &Joints) -> [f64; 4] {
    let path = trajectory.path();
    let mut worst = [0.0_f64; 4];
    // Bounds the number of samples for trajectories of minutes.
    let rate_hz = 1000.0_f64.min(2e5 / trajectory.cycle_time_s());
    for state in trajectory.samples(rate_hz) {
        let limits = path.limits_of(state.step);
        let torques = trajectory.torques_of(&state).torque_nm;
        let shares = |values: &Joints, limits: &Joints| {
            (0..7).map(|j| values[j].abs() / limits[j]).fold(0.0, f64::max)
        };
        let now = [
            shares(&torques, limits_nm),
            shares(&state.dq, limits.velocity_rad_s()),
            shares(&state.ddq, limits.acceleration_rad_s2()),
            shares(&state.dddq, limits.jerk_rad_s3()),
        ];
        for (worst, now) in worst.iter_mut().zip(now) {
            *worst = if now <= *worst { *worst } else { now };
        }
    }
    worst
}

/// Returns true if a torque limit is active in any motion.
fn is_held_back(trajectory: &Trajectory) -> bool {
    let mut limits = trajectory.motions().into_iter().flat_map(|motion| motion.limits);
    limits.any(|limit| matches!(limit.limit, Limit::Torque(_)))
}

/// Cross-validation: six programs with loads on the floor, a wall and at the ceiling, against the
/// plans of an independent solver without and with torque limits, with acceleration limits alone
/// and with jerk limits.
#[test]
fn durations_are_those_of_the_reference() {
    let cases = cases();
    assert_eq!(cases.len(), 6);
    for case in &cases {
        let expected = &case.motion_s;
        for (limits_torque, [jerk_s, acceleration_s]) in [
            (false, [expected.jerk, expected.acceleration]),
            (true, [expected.jerk_torque, expected.acceleration_torque]),
        ] {
            let path = case.path(limits_torque);
            for (timing, expected_s) in TIMINGS.iter().zip([jerk_s, acceleration_s]) {
                let timing = timing();
                let trajectory = Trajectory::plan(&path, timing).unwrap();
                let percent = 100.0 * (trajectory.motion_time_s() / expected_s - 1.0);
                let [torque, ..] = worst(&trajectory, &case.torque_limit_nm);
                println!(
                    "case {}, {}, torque limited {limits_torque}: {percent:+.3} %, torque \
                     {torque:.4}",
                    case.id,
                    timing.name(),
                );
                assert!((-0.05..=0.3).contains(&percent), "case {}: {percent} %", case.id);
                assert_eq!(is_held_back(&trajectory), limits_torque, "case {}", case.id);
                assert_eq!(torque <= MAX_TORQUE, limits_torque, "case {}: {torque}", case.id);
            }
        }
    }
}

/// Random programs on both robots, with loads up to the rated payload, for any mounting: planned
/// within all limits, or rejected for a load that cannot be held, which is verified.
#[test]
fn all_limits_are_kept() {
    let count = if std::env::var_os("IIWASIM_LONG").is_some() { 1000 } else { 40 };
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let mut worst_of_all = [[0.0_f64; 4]; 2];
    let mut faults = Vec::new();
    // 152: a spline of 5 mm whose third derivative has a peak between the points at which cells are
    // checked.
    for index in (0..count).chain((count <= 152).then_some(152)) {
        let LoadedProgram { robot, mut program, torque_limit_rel } = loaded_program(2026, index);
        let limits_nm = robot.limits().torque_nm.map(|limit| torque_limit_rel * limit);
        let free = JointPath::new(&program, &robot).unwrap();
        program.workcell.torque_limit_rel = Some(torque_limit_rel);
        let path = JointPath::new(&program, &robot).unwrap();
        for (k, timing) in TIMINGS.iter().enumerate() {
            let trajectory = match Trajectory::plan(&path, timing()) {
                Ok(trajectory) => trajectory,
                Err(TimingError::CannotHold { motion, joint, holding_nm, .. }) => {
                    *counts.entry("refused").or_default() += 1;
                    let most_nm = 0.99 * limits_nm[joint.index()];
                    let free = Trajectory::plan(&free, timing()).unwrap();
                    let held =
                        free.torques().motions.into_iter().find(|torques| torques.motion == motion);
                    let held_nm = held
                        .map_or(f64::INFINITY, |torques| torques.static_nm[joint.index()].abs());
                    if !(holding_nm.abs() > most_nm && held_nm > 0.999 * most_nm) {
                        faults.push(format!("{index}: {joint} holds {held_nm} Nm of {most_nm}"));
                    }
                    continue;
                }
                Err(error) => {
                    faults.push(format!("{index}: {error}"));
                    continue;
                }
            };
            let free_s = Trajectory::plan(&free, timing()).unwrap().cycle_time_s();
            let same = trajectory.cycle_time_s().to_bits() == free_s.to_bits();
            *counts.entry(if same { "as without" } else { "held back" }).or_default() += 1;
            let shares = worst(&trajectory, &limits_nm);
            let allowed = match k {
                0 => [
                    MAX_TORQUE,
                    tolerances::RATIOS[0],
                    tolerances::RATIOS[1],
                    tolerances::RATIOS[2],
                ],
                _ => [
                    MAX_TORQUE,
                    tolerances::SWEPT_RATIOS[0],
                    tolerances::SWEPT_RATIOS[1],
                    f64::INFINITY,
                ],
            };
            // The comparison also fails for NaN.
            if !(0..4).all(|i| shares[i] <= allowed[i]) {
                faults.push(format!("{index}, {}: {shares:.4?}", timing().name()));
            }
            if trajectory.cycle_time_s() < free_s * (1.0 - 5e-4) {
                faults
                    .push(format!("{index}: {} s, {free_s} s without", trajectory.cycle_time_s()));
            }
            for i in 0..4 {
                worst_of_all[k][i] = worst_of_all[k][i].max(shares[i]);
            }
        }
    }
    println!("{counts:?}, worst {worst_of_all:.4?}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(counts["held back"] > 5 && counts["as without"] > 50, "{counts:?}");
}

fn swings() -> Program {
    Program::from_deg([0.0, 30.0, 0.0, -60.0, 0.0, 30.0, 0.0])
        .ptp_deg([20.0, 80.0, 20.0, -30.0, 0.0, 50.0, 10.0])
        .blend(Blend::Fraction(0.3))
        .ptp_deg([60.0, 40.0, -20.0, -80.0, 30.0, 20.0, 90.0])
        .ptp_deg([0.0, 30.0, 0.0, -60.0, 0.0, 30.0, 0.0])
        .build()
}

fn loaded(mass_kg: f64, torque_limit_rel: f64) -> Program {
    let mut program = swings();
    let load = Load { mass_kg, center_mm: [0.0, 0.0, 80.0], ..Load::default() };
    program.motions.insert(0, Motion::Load(Some(load.into())));
    program.workcell.torque_limit_rel = Some(torque_limit_rel);
    program
}

fn plan(program: &Program, timing: Timing) -> Result<Trajectory, TimingError> {
    Trajectory::plan(&JointPath::new(program, &Robot::default()).unwrap(), timing)
}

/// An inactive limit leaves every bit of the plan unchanged.
#[test]
fn inactive_torque_limits_do_not_change_the_plan() {
    for timing in TIMINGS {
        let free = plan(&swings(), timing()).unwrap();
        let mut program = swings();
        program.workcell.torque_limit_rel = Some(1.0);
        let limited = plan(&program, timing()).unwrap();
        assert!(!is_held_back(&limited));
        let bits = |trajectory: &Trajectory| -> Vec<u64> {
            let states = trajectory.states();
            states
                .flat_map(|s| s.q.into_iter().chain(s.dq).chain([s.t_s]))
                .map(f64::to_bits)
                .collect()
        };
        assert_eq!(bits(&free), bits(&limited));
    }
}

/// Less torque and more load both increase the duration.
#[test]
fn less_torque_takes_longer() {
    for timing in TIMINGS {
        let duration_s =
            |mass_kg, limit| plan(&loaded(mass_kg, limit), timing()).unwrap().cycle_time_s();
        let by_limit = [1.0, 0.9, 0.8, 0.75].map(|limit| duration_s(7.0, limit));
        assert!(by_limit.windows(2).all(|pair| pair[0] < pair[1]), "{by_limit:?}");
        let by_mass = [4.0, 5.5, 7.0].map(|mass_kg| duration_s(mass_kg, 0.7 + 0.02 * mass_kg));
        assert!(by_mass.iter().all(|s| s.is_finite()), "{by_mass:?}");
        let by_mass = [3.0, 5.0, 7.0].map(|mass_kg| duration_s(mass_kg, 0.8));
        assert!(by_mass.windows(2).all(|pair| pair[0] < pair[1]), "{by_mass:?}");
    }
}

/// Returns a robot with links as asymmetric as the iiwa's, or mirrored. The axes of links 2, 4 and
/// 6 perpendicular to the plane of the arm at zero are z in their frames; for the other links it is
/// y.
fn lopsided(is_mirrored: bool) -> Robot {
    let sign = if is_mirrored { -1.0 } else { 1.0 };
    let links = std::array::from_fn(|i| {
        let mass_kg = [3.4, 4.0, 3.4, 4.0, 1.5, 2.4, 0.3][i];
        let inertia = 0.01 * mass_kg;
        let (center_m, products) = if i % 2 == 0 {
            ([0.01, sign * 0.03, 0.1], [sign * 0.001, 0.0005, sign * -0.001])
        } else {
            ([0.01, -0.05, sign * 0.03], [0.001, sign * 0.0005, sign * -0.001])
        };
        let [xy, xz, yz] = products.map(|product: f64| mass_kg * product);
        let inertia_kg_m2 = [inertia, xy, xz, 1.2 * inertia, yz, 0.9 * inertia];
        RigidBody { mass_kg, center_m, inertia_kg_m2 }
    });
    Robot::default().with_links(links)
}

/// A program mirrored about the vertical plane through the robot takes the same time: A1, A3, A5
/// and A7 are negated, and the links, the load and an inclined base are mirrored.
#[test]
fn a_mirrored_program_takes_as_long() {
    let mirrored = |q: Joints| [-q[0], q[1], -q[2], q[3], -q[4], q[5], -q[6]];
    for timing in TIMINGS {
        let mut program = loaded(6.0, 0.65);
        let [y_mm, roll_deg] = [25.0, 20.0];
        let mut other = program.clone();
        for (program, sign) in [(&mut program, 1.0), (&mut other, -1.0)] {
            program.workcell.mount = Mount::from_rpy_deg([sign * roll_deg, 10.0, 0.0]);
            if let Motion::Load(Some(load)) = &mut program.motions[0] {
                load.load.center_mm[1] = sign * y_mm;
            }
        }
        for motion in &mut other.motions {
            if let Motion::Ptp(ptp) = motion {
                ptp.target_rad = mirrored(ptp.target_rad);
            }
        }
        let duration_s = |program: &Program, robot: &Robot| {
            let path = JointPath::new(program, robot).unwrap();
            let trajectory = Trajectory::plan(&path, timing()).unwrap();
            assert!(is_held_back(&trajectory));
            trajectory.cycle_time_s()
        };
        let one = duration_s(&program, &lopsided(false));
        let mirrored = duration_s(&other, &lopsided(true));
        let not_mirrored = duration_s(&other, &lopsided(false));
        assert!((one / mirrored - 1.0).abs() < 1e-6, "{one} {mirrored}");
        assert!((one / not_mirrored - 1.0).abs() > 1e-5, "{one} {not_mirrored}");
    }
}

/// A load that cannot be held is a separate error, with motion, joint and torque.
#[test]
fn unholdable_poses_are_rejected() {
    let mut program = loaded(6.0, 0.4);
    program.motions.remove(0);
    let load = Load { mass_kg: 6.0, center_mm: [0.0, 0.0, 80.0], ..Load::default() };
    program.motions.insert(2, Motion::Load(Some(load.into())));
    // The load is picked up where it can be held, and the return motion leads through poses where
    // it cannot.
    for timing in TIMINGS {
        let error = plan(&program, timing()).unwrap_err();
        let TimingError::CannotHold { motion, joint, holding_nm, limit_nm, .. } = error else {
            panic!("{error}")
        };
        assert_eq!((motion, joint), (MotionIndex::new(3), Joint::A2), "{error}");
        assert!(holding_nm < -0.99 * limit_nm && (limit_nm - 70.4).abs() < 1e-9, "{error}");
        assert!(error.to_string().contains("motion 4: A2 cannot hold the arm"), "{error}");
    }
}

/// Torque spent on friction at full speed is not available for the motion.
#[test]
fn friction_is_taken_off() {
    let friction = Friction { viscous_nm_s_rad: [2.0; 7], coulomb_nm: [3.0; 7] };
    let robot = Robot::default().with_friction(friction);
    for timing in TIMINGS {
        let program = loaded(7.0, 0.85);
        let path = JointPath::new(&program, &robot).unwrap();
        let trajectory = Trajectory::plan(&path, timing()).unwrap();
        let without = plan(&program, timing()).unwrap();
        assert!(trajectory.cycle_time_s() > without.cycle_time_s());
        let [torque, ..] = worst(&trajectory, &robot.limits().torque_nm.map(|limit| 0.85 * limit));
        assert!(torque <= MAX_TORQUE, "{torque}");
    }
}

/// A changed program is planned as from scratch.
#[test]
fn planning_again_keeps_limits_of_torque() {
    let robot = Robot::default();
    let program = loaded(7.0, 0.8);
    let options = (PathOptions::default(), JerkOptions::default());
    let mut plan_again = Replanner::new(program.clone(), &robot, options.0, options.1).unwrap();
    let Motion::Ptp(mut ptp) = program.motions[2].clone() else { panic!("a motion to joints") };
    ptp.target_rad[1] += 0.1;
    plan_again.replace(MotionIndex::new(2), Motion::Ptp(ptp)).unwrap();
    let from_nothing = plan(plan_again.program(), Timing::jerk_limited()).unwrap();
    let off = plan_again.cycle_time_s() / from_nothing.cycle_time_s() - 1.0;
    assert!(off.abs() < 1e-3, "{off}");
    let limits_nm = robot.limits().torque_nm.map(|limit| 0.8 * limit);
    let [torque, ..] = worst(&plan_again.trajectory(), &limits_nm);
    assert!(torque <= MAX_TORQUE, "{torque}");

    let heavy = Load { mass_kg: 60.0, center_mm: [0.0, 0.0, 80.0], ..Load::default() };
    let heavy = Motion::Load(Some(heavy.into()));
    let error = plan_again.replace(MotionIndex::new(0), heavy).unwrap_err();
    assert!(matches!(error, PlanError::Timing(TimingError::CannotHold { .. })), "{error}");
    assert!((plan_again.cycle_time_s() / from_nothing.cycle_time_s() - 1.0 - off).abs() < 1e-12);
}

/// Parses the key of programs, and its range.
#[test]
fn programs_state_the_torque_limit() {
    let text = |percent: &str| {
        format!(
            r#"{{ "version": 1, "limit_torque_percent": {percent},
                 "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
                 "motions": [{{ "type": "ptp", "joints_deg": [10, 0, 0, 0, 0, 0, 0] }}] }}"#
        )
    };
    let program = Program::from_json(&text("70.1")).unwrap();
    assert_eq!(program.workcell.torque_limit_rel, Some(70.1 / 100.0));
    assert_eq!(Program::from_json(&program.to_json()).unwrap(), program);
    assert_eq!(Program::from_json(&text("null")).unwrap().workcell.torque_limit_rel, None);
    for wrong in ["0", "-5", "0.5", "1001"] {
        let error = Program::from_json(&text(wrong)).unwrap_err();
        assert!(error.to_string().contains("it must be from 1 to 1000 %"), "{error}");
        assert_eq!(error.place().line, 1, "{error}");
    }
    let error: ProgramError = Program::from_json(&text("true")).unwrap_err();
    assert!(error.to_string().contains("expected a number"), "{error}");
}
