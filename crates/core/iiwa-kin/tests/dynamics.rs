//! Torques, energies and mass matrix, compared with an independent implementation and with each
//! other.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use iiwa_kin::{Dynamics, Friction, Joints, Load, Mount, RigidBody, Robot, vector};
use nalgebra::SMatrix;
use proptest::prelude::*;
use serde_json::Value;

/// Cases of `fixtures/reference/rnea.json`: Pinocchio 4.1.0.
fn cases() -> Vec<Value> {
    let file = "../../../fixtures/reference/rnea.json";
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
    let file: Value = serde_json::from_str(&text).unwrap();
    let mut cases = file["cases"].as_array().unwrap().clone();
    for case in &mut cases {
        let inertials = case["inertials"].as_str().unwrap();
        case["links"] = file["tables"][inertials]["links"].clone();
    }
    cases
}

fn read<const N: usize>(value: &Value) -> [f64; N] {
    let numbers: Vec<f64> = serde_json::from_value(value.clone()).unwrap();
    numbers.try_into().unwrap()
}

fn body(value: &Value) -> RigidBody {
    RigidBody {
        mass_kg: value["mass_kg"].as_f64().unwrap(),
        center_m: read(&value["center_m"]),
        inertia_kg_m2: read(&value["inertia_kg_m2"]),
    }
}

/// Dynamics of a case.
fn arm(case: &Value) -> Dynamics {
    let links: Vec<_> = case["links"].as_array().unwrap().iter().map(body).collect();
    let robot = Robot::built_in(case["robot"].as_str().unwrap()).unwrap();
    let robot = robot.with_flange_m(case["flange_m"].as_f64().unwrap()).unwrap();
    let robot = robot.with_links(links.try_into().unwrap());
    let dynamics = robot.dynamics().with_gravity_m_s2(read(&case["gravity_m_s2"]));
    if case["load"].is_null() { dynamics } else { dynamics.with_body(&body(&case["load"])) }
}

fn largest_difference(a: &Joints, b: &Joints) -> f64 {
    vector::sub(a, b).into_iter().map(f64::abs).fold(0.0, f64::max)
}

/// Cross-validated: Pinocchio 4.1.0, five tables, both flanges, loads, floor, ceiling and slopes.
#[test]
fn agrees_with_pinocchio() {
    let cases = cases();
    assert_eq!(cases.len(), 50);
    let mut worst = 0.0_f64;
    for case in &cases {
        let dynamics = arm(case);
        let [q, qd, qdd] = ["q_rad", "qd_rad_s", "qdd_rad_s2"].map(|key| read(&case[key]));
        let torques = dynamics.torques(&q, &qd, &qdd);
        let gravity = dynamics.gravity_torques(&q);
        worst = worst.max(largest_difference(&torques, &read(&case["tau_nm"])));
        worst = worst.max(largest_difference(&gravity, &read(&case["gravity_tau_nm"])));
        let energies = [
            (dynamics.kinetic_energy_j(&q, &qd), "kinetic_energy_j"),
            (dynamics.potential_energy_j(&q), "potential_energy_j"),
        ];
        for (actual, key) in energies {
            worst = worst.max((actual - case[key].as_f64().unwrap()).abs());
        }
        let matrix = dynamics.mass_matrix(&q);
        let diagonal = std::array::from_fn(|j| matrix[j][j]);
        let expected = read(&case["mass_matrix_diagonal_kg_m2"]);
        worst = worst.max(largest_difference(&diagonal, &expected));
    }
    assert!(worst < 1e-9, "off by {worst}");
}

/// The built-in tables equal those of the reference cases.
#[test]
fn built_in_links_are_those_of_lbr_description() {
    let mut compared = 0;
    for case in cases() {
        if case["inertials"].as_str().unwrap().starts_with("lbr_description") {
            let robot = Robot::built_in(case["robot"].as_str().unwrap()).unwrap();
            let robot = robot.with_flange_m(case["flange_m"].as_f64().unwrap()).unwrap();
            let dynamics = robot.dynamics().with_gravity_m_s2(read(&case["gravity_m_s2"]));
            let q = read(&case["q_rad"]);
            let without_load = arm(&{
                let mut case = case.clone();
                case["load"] = Value::Null;
                case
            });
            assert_eq!(dynamics.gravity_torques(&q), without_load.gravity_torques(&q));
            compared += 1;
        }
    }
    assert_eq!(compared, 20);
    let weights = Robot::BUILT_IN
        .map(|name| Robot::built_in(name).unwrap().link_mass_kg().iter().sum::<f64>());
    assert!((weights[0] - 23.9).abs() < 0.001 && (weights[1] - 29.9).abs() < 0.03, "{weights:?}");
}

/// Holding torques of A2 and A4, in Nm, of a table of poses and published models.
#[test]
fn torques_at_rest_hold_the_weight() {
    let at = |name: &str, degrees: Joints| {
        Robot::built_in(name).unwrap().dynamics().gravity_torques(&degrees.map(f64::to_radians))
    };
    let aside = [0.0, 90.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let bent = [0.0, 60.0, 45.0, -60.0, 30.0, 60.0, 0.0];
    for (name, pose, a2, a4) in [
        (Robot::BUILT_IN[0], aside, -65.3, 18.5),
        (Robot::BUILT_IN[0], bent, -53.8, 13.4),
        (Robot::BUILT_IN[1], aside, -69.8, 18.9),
        (Robot::BUILT_IN[1], bent, -57.7, 13.7),
    ] {
        let torques = at(name, pose);
        assert!((torques[1] - a2).abs() < 0.06, "{torques:?}");
        assert!((torques[3] - a4).abs() < 0.06, "{torques:?}");
    }
}

fn joints(limit: f64) -> impl Strategy<Value = Joints> {
    prop::array::uniform7(-limit..limit)
}

prop_compose! {
    fn any_load()(
        mass_kg in 0.0..14.0_f64,
        center_mm in prop::array::uniform3(-200.0..200.0_f64),
        part in prop::array::uniform3(1e-3..0.1_f64),
        abc_rad in prop::array::uniform3(-3.0..3.0_f64),
    ) -> Load {
        let [x, y, z] = part;
        Load { mass_kg, center_mm, inertia_kg_m2: [y + z, x + z, x + y], abc_rad }
    }
}

prop_compose! {
    fn any_arm()(
        big in any::<bool>(),
        load in prop::option::of(any_load()),
        rpy_rad in prop::array::uniform3(-3.2..3.2_f64),
        flange_mass_kg in prop_oneof![Just(0.0), 0.1..2.0_f64],
    ) -> Dynamics {
        let robot = Robot::built_in(Robot::BUILT_IN[usize::from(big)]).unwrap();
        let dynamics =
            robot.with_flange_mass_kg(flange_mass_kg).dynamics().with_mount(&Mount { rpy_rad });
        load.map_or(dynamics, |load| dynamics.with_load(&load))
    }
}

/// Positions, velocities and accelerations of a motion at a time.
fn motion(start: &Joints, speed: &Joints, swing: &Joints, t: f64) -> [Joints; 3] {
    let at = |f: fn(f64, f64, f64, f64) -> f64| -> Joints {
        std::array::from_fn(|j| f(start[j], speed[j], swing[j], t))
    };
    [
        at(|q, v, a, t| q + v * t + a * (3.0 * t).sin()),
        at(|_, v, a, t| v + 3.0 * a * (3.0 * t).cos()),
        at(|_, _, a, t| -9.0 * a * (3.0 * t).sin()),
    ]
}

proptest! {
    /// The work of the joint torques equals the increase in energy.
    #[test]
    fn work_is_the_change_of_energy(
        dynamics in any_arm(), start in joints(2.0), speed in joints(1.5), swing in joints(0.5),
    ) {
        // Gauss's rule with two points, which is of fourth order.
        const STEPS: u32 = 400;
        let step = 1.0 / f64::from(STEPS);
        let mut work = 0.0;
        for k in 0..STEPS {
            for place in [0.5 - 0.5 / 3.0_f64.sqrt(), 0.5 + 0.5 / 3.0_f64.sqrt()] {
                let [q, qd, qdd] = motion(&start, &speed, &swing, (f64::from(k) + place) * step);
                work += 0.5 * step * vector::dot(&dynamics.torques(&q, &qd, &qdd), &qd);
            }
        }
        let energy = |t: f64| {
            let [q, qd, _] = motion(&start, &speed, &swing, t);
            dynamics.kinetic_energy_j(&q, &qd) + dynamics.potential_energy_j(&q)
        };
        let gained = energy(1.0) - energy(0.0);
        prop_assert!((work - gained).abs() < 1e-6 * (1.0 + gained.abs()), "{work} J, {gained} J");
    }

    #[test]
    fn gravity_torques_are_the_slope_of_the_potential_energy(
        dynamics in any_arm(),
        q in joints(3.0),
    ) {
        let torques = dynamics.gravity_torques(&q);
        for j in 0..7 {
            let [mut more, mut less] = [q, q];
            more[j] += 1e-5;
            less[j] -= 1e-5;
            let slope =
                (dynamics.potential_energy_j(&more) - dynamics.potential_energy_j(&less)) / 2e-5;
            prop_assert!((torques[j] - slope).abs() < 1e-6, "joint {}", j + 1);
        }
        let still = dynamics.torques(&q, &[0.0; 7], &[0.0; 7]);
        prop_assert!(largest_difference(&torques, &still) < 1e-11);
    }

    /// The mass matrix equals the Newton-Euler torques of unit accelerations.
    #[test]
    fn mass_matrices_are_those_of_bodies(dynamics in any_arm(), q in joints(3.0)) {
        let matrix = dynamics.mass_matrix(&q);
        let weightless = dynamics.with_gravity_m_s2([0.0; 3]);
        for j in 0..7 {
            let mut unit = [0.0; 7];
            unit[j] = 1.0;
            let column = weightless.torques(&q, &[0.0; 7], &unit);
            prop_assert!(largest_difference(&matrix[j], &column) < 1e-12);
            prop_assert!((0..7).all(|i| matrix[i][j].to_bits() == matrix[j][i].to_bits()));
        }
        let matrix = SMatrix::<f64, 7, 7>::from_fn(|i, j| matrix[i][j]);
        prop_assert!(matrix.cholesky().is_some());
    }

    #[test]
    fn parts_of_path_torques_add_up(
        dynamics in any_arm(), q in joints(3.0), dq in joints(1.0), ddq in joints(2.0),
        speed in -3.0..3.0_f64, acceleration in -20.0..20.0_f64,
    ) {
        let velocity = vector::scale(speed, &dq);
        let change = vector::add_scaled(&vector::scale(acceleration, &dq), speed * speed, &ddq);
        let whole = dynamics.torques(&q, &velocity, &change);
        let parts = dynamics.path_torques(&q, &dq, &ddq).at(speed, acceleration);
        prop_assert!(largest_difference(&whole, &parts) < 1e-10);
    }

    /// Bit-identical for any length, and for angles outside the range of the vectorised kernels.
    #[test]
    fn batches_are_as_one_by_one(
        dynamics in any_arm(),
        places in prop::collection::vec((joints(3.0), joints(2.0), joints(9.0)), 0..40),
        far in prop::option::of(0..40_usize),
    ) {
        let mut q: Vec<Joints> = places.iter().map(|place| place.0).collect();
        let first: Vec<Joints> = places.iter().map(|place| place.1).collect();
        let second: Vec<Joints> = places.iter().map(|place| place.2).collect();
        if let Some(q) = far.and_then(|far| q.get_mut(far)) {
            q[3] = 1e9;
        }
        let mut torques = vec![[0.0; 7]; q.len()];
        dynamics.torques_batch(&q, &first, &second, &mut torques);
        let mut parts = vec![iiwa_kin::PathTorques::default(); q.len()];
        dynamics.path_torques_batch(&q, &first, &second, &mut parts);
        let (mut with_gravity, mut gravity) = (torques.clone(), torques.clone());
        dynamics.torques_with_gravity_batch(&q, &first, &second, &mut with_gravity, &mut gravity);
        prop_assert_eq!(&with_gravity, &torques);
        for i in 0..q.len() {
            prop_assert_eq!(gravity[i], dynamics.gravity_torques(&q[i]));
            prop_assert_eq!(torques[i], dynamics.torques(&q[i], &first[i], &second[i]));
            prop_assert_eq!(parts[i], dynamics.path_torques(&q[i], &first[i], &second[i]));
        }
    }

    /// A robot on the ceiling needs the opposite holding torques.
    #[test]
    fn upside_down_gravity_is_the_other_way_round(load in any_load(), q in joints(3.0)) {
        let floor = Robot::default().dynamics().with_load(&load);
        let ceiling = floor.with_mount(&Mount::from_rpy_deg([180.0, 0.0, 40.0]));
        let (up, down) = (floor.gravity_torques(&q), ceiling.gravity_torques(&q));
        prop_assert!(largest_difference(&up, &down.map(|torque| -torque)) < 1e-12);
    }

    #[test]
    fn a_load_is_a_heavier_last_link(
        load in any_load(),
        flange_m in 0.05..0.3_f64,
        q in joints(3.0),
        qd in joints(2.0),
        qdd in joints(9.0),
    ) {
        let robot = Robot::lbr_iiwa_14_r820().with_flange_m(flange_m).unwrap();
        let mut links = robot.links();
        let mut carried = load.body();
        carried.center_m[2] += flange_m;
        links[6] = links[6].with(&carried);
        let heavier = robot.clone().with_links(links).dynamics();
        let loaded = robot.dynamics().with_load(&load);
        let [a, b] = [heavier, loaded].map(|arm| arm.torques(&q, &qd, &qdd));
        prop_assert!(largest_difference(&a, &b) < 1e-11);
        prop_assert!(
            (heavier.kinetic_energy_j(&q, &qd) - loaded.kinetic_energy_j(&q, &qd)).abs() < 1e-11
        );
        // Split payloads give the same torques as the whole payload.
        let half = Load {
            mass_kg: 0.5 * load.mass_kg,
            inertia_kg_m2: load.inertia_kg_m2.map(|i| 0.5 * i),
            ..load
        };
        let twice = robot.dynamics().with_load(&half).with_load(&half);
        prop_assert!(largest_difference(&twice.torques(&q, &qd, &qdd), &b) < 1e-11);
    }
}

/// The flange mass is a point mass behind the flange face.
#[test]
fn a_flange_may_have_a_mass() {
    let robot = Robot::default();
    let aside = [0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0];
    let torque = |robot: &Robot| robot.dynamics().gravity_torques(&aside)[1];
    let heavier = robot.clone().with_flange_mass_kg(0.5);
    let more = torque(&heavier) - torque(&robot);
    assert!((more + 0.5 * 9.81 * (0.8 + 0.152 - 0.013)).abs() < 1e-9, "{more}");
    assert_eq!(heavier.link_mass_kg(), robot.link_mass_kg());
}

#[test]
fn friction_is_apart() {
    let friction = Friction { viscous_nm_s_rad: [0.1; 7], coulomb_nm: [0.2; 7] };
    let plain = Robot::default();
    let robot = plain.clone().with_friction(friction);
    assert_eq!(robot.dynamics().friction(), &friction);
    assert_eq!(plain.friction(), &Friction::default());
    let (q, qd) = ([0.3; 7], [0.5; 7]);
    assert_eq!(robot.dynamics().torques(&q, &qd, &qd), plain.dynamics().torques(&q, &qd, &qd));
}

#[test]
fn impossible_inertias_are_refused() {
    let body = |inertia_kg_m2| RigidBody { mass_kg: 1.0, center_m: [0.0; 3], inertia_kg_m2 };
    assert!(RigidBody::point(1.0, [0.1; 3]).is_possible());
    assert!(body([1.0, 0.0, 0.0, 1.0, 0.0, 1.0]).is_possible());
    // An identified inertia that no real body has: the largest moment exceeds the sum of the
    // others.
    assert!(body([1.0, 0.0, 0.0, 1.0, 0.0, 3.0]).is_possible());
    assert!(!body([-1.0, 0.0, 0.0, 1.0, 0.0, 1.0]).is_possible());
    assert!(!body([1.0, 1.1, 0.0, 1.0, 0.0, 1.0]).is_possible());
    assert!(!body([1.0, 0.8, 0.8, 1.0, -0.8, 1.0]).is_possible());
    assert!(!body([f64::NAN, 0.0, 0.0, 1.0, 0.0, 1.0]).is_possible());
}
