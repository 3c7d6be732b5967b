//! Torques along trajectories: compared with those of an independent solver, and with the energy
//! balance.

use iiwa_kin::{Friction, Joints, Load, Robot, vector};
use iiwa_path::JointPath;
use iiwa_program::{Motion, MotionIndex, Mount, Program};
use iiwa_traj::{SweepOptions, Timing, TorqueFigures, Trajectory};
use iiwasim_tests::{
    random::programs,
    torque_reference::{Energy, TorqueCase, cases},
};
use proptest::prelude::*;

/// Returns the largest torques of all motions, relative to the limits of a case; and the largest
/// static torque.
fn peaks(case: &TorqueCase, figures: &TorqueFigures) -> (Joints, f64) {
    let share = |torques: &Joints, j: usize| torques[j].abs() / case.torque_limit_nm[j];
    let peak = |j| figures.motions.iter().map(|m| share(&m.peak_nm, j)).fold(0.0, f64::max);
    let still = figures.motions.iter().flat_map(|m| (0..7).map(|j| share(&m.static_nm, j)));
    (std::array::from_fn(peak), still.fold(0.0, f64::max))
}

/// Cross-validation: trajectories of an independent solver for six programs with loads on the
/// floor, a wall and at the ceiling, and Pinocchio's torques along them.
#[test]
fn peaks_and_work_are_those_of_the_reference() {
    let cases = cases();
    assert_eq!(cases.len(), 6);
    let mut sum_off = 0.0;
    for case in &cases {
        let path = case.path(false);
        for (timing, expected) in [
            (Timing::Acceleration(SweepOptions::default()), &case.peak_torque_share.acceleration),
            (Timing::jerk_limited(), &case.peak_torque_share.jerk),
        ] {
            let figures = Trajectory::plan(&path, timing).unwrap().torques();
            let (peaks, still) = peaks(case, &figures);
            assert!((still - case.static_peak_share).abs() < 1e-4, "case {}: {still}", case.id);
            let off: Joints = std::array::from_fn(|j| (peaks[j] - expected[j]).abs());
            println!("case {}: peaks {peaks:.3?}, off by {off:.4?} of the limits", case.id);
            // The accelerations of both solvers differ where they jump, or nearly so: in blends.
            assert!(off.iter().all(|off| *off < 0.017), "case {}: {off:?}", case.id);
            sum_off += off.iter().sum::<f64>();
            let Timing::Jerk(_) = timing else { continue };
            let Energy { positive_j, negative_j, positive_per_joint_j, peak_power_w } =
                &case.energy.jerk;
            let sum = |joints: &Joints| joints.iter().sum::<f64>();
            let actual_j = [sum(&figures.positive_work_j), sum(&figures.negative_work_j)];
            println!("   work {actual_j:.2?} J, peak power {:.1} W", figures.peak_power_w);
            for (actual, expected) in actual_j.iter().zip([positive_j, negative_j]) {
                assert!((actual / expected - 1.0).abs() < 3e-3, "case {}: {actual}", case.id);
            }
            for (actual, expected) in figures.positive_work_j.iter().zip(positive_per_joint_j) {
                assert!((actual - expected).abs() < 0.2, "case {}: {actual}", case.id);
            }
            let power = figures.peak_power_w / peak_power_w;
            assert!((power - 1.0).abs() < 0.035, "case {}: {power}", case.id);
        }
    }
    let mean_off = sum_off / 84.0;
    println!("on average off by {mean_off:.5} of the limits");
    assert!(mean_off < 2e-3);
}

fn work(figures: &TorqueFigures) -> f64 {
    figures.positive_work_j.iter().chain(&figures.negative_work_j).sum()
}

fn picked_up(program: &mut Program) {
    let load = Load {
        mass_kg: 4.0,
        center_mm: [20.0, -30.0, 80.0],
        inertia_kg_m2: [0.02, 0.03, 0.025],
        abc_rad: [0.3, -0.2, 0.1],
    };
    program.motions.insert(0, Motion::Load(Some(load.into())));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// The work of the joints between stops is the gain in potential energy of arm and load.
    #[test]
    fn work_is_the_change_of_energy(
        mut program in programs(8),
        limits_jerk in any::<bool>(),
        rpy_deg in prop::array::uniform3(-180.0..180.0_f64),
    ) {
        picked_up(&mut program);
        program.workcell.mount = Mount::from_rpy_deg(rpy_deg);
        let path = JointPath::new(&program, &Robot::default()).unwrap();
        let timing = if limits_jerk {
            Timing::jerk_limited()
        } else {
            Timing::Acceleration(SweepOptions::default())
        };
        let trajectory = Trajectory::plan(&path, timing).unwrap();
        let figures = trajectory.torques();
        let dynamics = path.dynamics(MotionIndex::new(0));
        let height = |q: &Joints| dynamics.potential_energy_j(q);
        let gained = height(&trajectory.at(trajectory.cycle_time_s()).q) - height(path.start_rad());
        let actual = work(&figures);
        prop_assert!((actual - gained).abs() < 1e-3, "{actual} J, {gained} J");
        prop_assert!(figures.positive_work_j.iter().all(|work| *work >= 0.0));
        prop_assert!(figures.negative_work_j.iter().all(|work| *work <= 0.0));

        // The peaks agree with dense sampling.
        let motions = trajectory.motions();
        prop_assert_eq!(motions.len(), figures.motions.len());
        for (motion, torques) in motions.iter().zip(&figures.motions) {
            prop_assert_eq!(motion.motion, torques.motion);
            for k in 0..=200 {
                let t_s = motion.start_s + f64::from(k) / 200.0 * (motion.end_s - motion.start_s);
                let state = trajectory.at(t_s);
                if state.motion != motion.motion {
                    continue;
                }
                let actual = trajectory.torques_of(&state);
                for j in 0..7 {
                    let limit_nm = |nm: f64| 1.003 * nm.abs() + 0.05;
                    prop_assert!(actual.torque_nm[j].abs() <= limit_nm(torques.peak_nm[j]));
                    prop_assert!(actual.gravity_nm[j].abs() <= limit_nm(torques.static_nm[j]));
                }
            }
            prop_assert!(torques.peak_at_s.iter().all(|t_s| *t_s >= motion.start_s || *t_s == 0.0));
        }
    }
}

/// Friction requires additional work.
#[test]
fn friction_costs_work() {
    let program = Program::from_deg([0.0, 20.0, 0.0, -60.0, 0.0, 40.0, 0.0])
        .ptp_deg([60.0, 50.0, 30.0, -80.0, 20.0, 10.0, 90.0])
        .ptp_deg([0.0, 20.0, 0.0, -60.0, 0.0, 40.0, 0.0])
        .build();
    let friction = Friction { viscous_nm_s_rad: [0.0; 7], coulomb_nm: [0.3; 7] };
    let robot = Robot::default().with_friction(friction);
    let path = JointPath::new(&program, &robot).unwrap();
    let figures = Trajectory::plan(&path, Timing::jerk_limited()).unwrap().torques();
    let turned: f64 = vector::sub(
        path.start_rad(),
        &[60.0, 50.0, 30.0, -80.0, 20.0, 10.0, 90.0].map(f64::to_radians),
    )
    .iter()
    .map(|turn| 2.0 * turn.abs())
    .sum();
    assert!((work(&figures) - 0.3 * turned).abs() < 1e-3, "{} {}", work(&figures), 0.3 * turned);
}

/// A load acts from its pick-up to its put-down.
#[test]
fn loads_count_while_they_hang_there() {
    let text = r#"{ "version": 1, "start": { "joints_deg": [0, 60, 0, -60, 0, 60, 0] }, "motions": [
        { "type": "ptp", "joints_deg": [20, 60, 0, -60, 0, 60, 0] },
        { "type": "load", "load": { "mass_kg": 5, "center_mm": [0, 0, 60] } },
        { "type": "ptp", "joints_deg": [0, 60, 0, -60, 0, 60, 0] },
        { "type": "load", "load": null },
        { "type": "wait", "seconds": 0.5 } ] }"#;
    let program = Program::from_json(text).unwrap();
    let path = JointPath::new(&program, &Robot::default()).unwrap();
    let trajectory = Trajectory::plan(&path, Timing::jerk_limited()).unwrap();
    let figures = trajectory.torques();
    let numbers: Vec<_> = figures.motions.iter().map(|motion| motion.motion.number()).collect();
    assert_eq!(numbers, [1, 3, 5]);
    let held: Vec<f64> = figures.motions.iter().map(|motion| motion.static_nm[1]).collect();
    assert!(
        held[0] < 0.0 && (held[0] - held[2]).abs() < 1e-9 && held[1] < held[0] - 20.0,
        "{held:?}"
    );
    assert!(trajectory.at(trajectory.cycle_time_s() - 0.1).motion == MotionIndex::new(4));
    let plain = text
        .replace(r#"{ "type": "load", "load": { "mass_kg": 5, "center_mm": [0, 0, 60] } },"#, "");
    let plain =
        Program::from_json(&plain.replace(r#"{ "type": "load", "load": null },"#, "")).unwrap();
    let plain = JointPath::new(&plain, &Robot::default()).unwrap();
    let plain = Trajectory::plan(&plain, Timing::jerk_limited()).unwrap();
    assert_eq!(plain.cycle_time_s().to_bits(), trajectory.cycle_time_s().to_bits());
}
