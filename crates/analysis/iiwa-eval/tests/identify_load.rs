//! Payloads and friction identified from recordings with torques.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_eval::{
    VirtualRobot, experiment,
    identify::{RecordedRun, TorqueEstimates, identify},
};
use iiwa_kin::{Friction, Load, Mount, Robot};
use iiwa_log::JointLog;
use iiwa_program::{Motion, Program};

const LOAD: Load = Load {
    mass_kg: 4.2,
    center_mm: [12.0, -25.0, 85.0],
    inertia_kg_m2: [0.012, 0.018, 0.009],
    abc_rad: [0.3, 0.0, 0.0],
};

/// Creates twelve random motions at all speeds.
fn program() -> Program {
    experiment::settle(&Robot::default(), 12, 3).program
}

fn arm(seed: u64) -> VirtualRobot {
    let mut arm = VirtualRobot::new(Robot::default(), seed);
    arm.period_s = 0.005;
    arm.torque_noise_nm = Some(0.1);
    arm.load = Some(LOAD);
    arm
}

fn identify_torques(runs: &[(&Program, &JointLog)], model: &Robot) -> TorqueEstimates {
    let recordings: Vec<_> =
        runs.iter().map(|(program, log)| RecordedRun { program, log }).collect();
    identify(&recordings, model).unwrap().torques.unwrap()
}

/// The table of issue 18: mass within 0.05 kg and centre of mass within 3 mm, and the true values
/// within the stated uncertainty for 90 % of 50 recordings.
#[test]
fn a_load_is_found_and_its_uncertainty_holds() {
    const RECORDINGS: u64 = 50;
    let (program, model) = (program(), Robot::default());
    let mut holds = [0; 4];
    let mut worst = [0.0_f64; 4];
    let mut stated = [0.0_f64; 4];
    for seed in 0..RECORDINGS {
        let log = arm(seed).run(&program).unwrap();
        let torques = identify_torques(&[(&program, &log)], &model);
        let load = &torques.loads[0];
        let [x, y, z] = load.center_mm;
        let truth = [LOAD.mass_kg, LOAD.center_mm[0], LOAD.center_mm[1], LOAD.center_mm[2]];
        for (k, (estimate, truth)) in [load.mass_kg, x, y, z].into_iter().zip(truth).enumerate() {
            let estimate = estimate.unwrap();
            holds[k] += u32::from(estimate.holds(truth));
            worst[k] = worst[k].max((estimate.value - truth).abs());
            stated[k] = stated[k].max(estimate.uncertainty);
        }
    }
    println!("off at most {worst:?}, stated at most {stated:?}, hold {holds:?} of {RECORDINGS}");
    assert!(worst[0] <= 0.05 && stated[0] <= 0.05, "mass: {worst:?} {stated:?}");
    assert!(worst[1..].iter().chain(&stated[1..]).all(|mm| *mm <= 3.0), "{worst:?} {stated:?}");
    assert!(holds.iter().all(|held| *held >= 45), "{holds:?}");
}

/// Alternating payloads, the stated one and another one, with friction and position noise.
#[test]
fn friction_and_loads_of_several_recordings_are_separated() {
    let friction = Friction {
        viscous_nm_s_rad: [0.24, 0.37, 0.11, 0.1, 0.1, 0.12, 0.1],
        coulomb_nm: [0.32, 0.18, 0.07, 0.18, 0.03, 0.13, 0.09],
    };
    let mut empty = arm(7);
    empty.robot = empty.robot.with_friction(friction);
    (empty.load, empty.noise_rad, empty.period_s) = (None, 1e-5, 0.001);
    let plain = program();
    let mut stating = plain.clone();
    stating.motions.insert(0, Motion::Load(Some(Load { mass_kg: 4.0, ..LOAD }.into())));
    let logs = [empty.run(&plain).unwrap(), {
        empty.load = Some(LOAD);
        empty.run(&stating).unwrap()
    }];
    let torques = identify_torques(&[(&plain, &logs[0]), (&stating, &logs[1])], &Robot::default());
    let [none, some] = &torques.loads[..] else { panic!("{} loads", torques.loads.len()) };
    assert!(none.is_nothing() && none.load().is_none(), "{none:?}");
    assert_eq!((&none.recordings[..], &some.recordings[..]), (&[0][..], &[1][..]));
    assert_eq!(some.stated.unwrap().mass_kg, 4.0);
    assert!((some.load().unwrap().mass_kg - LOAD.mass_kg).abs() < 0.01, "{some:?}");
    let friction_estimate = torques.friction(&Friction::default());
    for j in 0..7 {
        let [viscous, coulomb] = [
            friction_estimate.viscous_nm_s_rad[j] - friction.viscous_nm_s_rad[j],
            friction_estimate.coulomb_nm[j] - friction.coulomb_nm[j],
        ];
        assert!(viscous.abs() < 0.03 && coulomb.abs() < 0.03, "A{}: {viscous} {coulomb}", j + 1);
    }
    println!("{torques:#?}");
}

/// Other recorders may invert the torque sign of KUKA's controller.
#[test]
fn the_sign_of_torques_is_detected_by_the_weight() {
    let (program, mut log) = (program(), arm(1).run(&program()).unwrap());
    for torque in log.torques_nm.iter_mut().flatten().flatten() {
        *torque = -*torque;
    }
    let torques = identify_torques(&[(&program, &log)], &Robot::default());
    assert!(torques.turned);
    assert!((torques.loads[0].load().unwrap().mass_kg - LOAD.mass_kg).abs() < 0.01);
    // On the ceiling, the torques have the sign of the model.
    let mut hanging = program.clone();
    hanging.workcell.mount = Mount::from_rpy_deg([180.0, 0.0, 0.0]);
    let torques =
        identify_torques(&[(&hanging, &arm(1).run(&hanging).unwrap())], &Robot::default());
    assert!(!torques.turned);
    assert!((torques.loads[0].load().unwrap().mass_kg - LOAD.mass_kg).abs() < 0.01);
}

/// Only A1 rotates, with the arm pointing straight up: gravity acts along all axes, and nothing is
/// lifted.
#[test]
fn figures_without_evidence_are_not_reported() {
    let still = Program::from_deg([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        .ptp_deg([60.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        .ptp_deg([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        .build();
    let torques = identify_torques(&[(&still, &arm(2).run(&still).unwrap())], &Robot::default());
    let load = &torques.loads[0];
    assert_eq!((load.mass_kg, load.center_mm[2], load.load()), (None, None, None));
    assert!(load.untold().contains(&"the mass"), "{:?}", load.untold());
    assert!(torques.coulomb_nm[0].is_some() && torques.coulomb_nm[1].is_none());
}

/// Pick and place: no single payload explains the torques.
#[test]
fn loads_that_change_are_not_mixed() {
    let mut program = program();
    program.motions.insert(4, Motion::Load(Some(LOAD.into())));
    let log = arm(3).run(&program).unwrap();
    let recordings = [RecordedRun { program: &program, log: &log }];
    let identified = identify(&recordings, &Robot::default()).unwrap();
    assert_eq!(identified.torques, None);
    assert_eq!(identified.unused_torques.len(), 1);
}
