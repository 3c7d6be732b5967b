//! Virtual robots, identified from what they did.

use fastrand::Rng;
use iiwa_eval::{
    VirtualRobot,
    identify::{Identified, Recording, identify},
};
use iiwa_kin::{Joints, Robot};
use iiwa_log::JointLog;
use iiwa_path::{Blend, Motion, Program, Ptp};

fn deg(joints: Joints) -> Joints {
    joints.map(f64::to_radians)
}

fn program(start_rad: Joints, motions: impl IntoIterator<Item = Ptp>) -> Program {
    Program { robot: None, start_rad, motions: motions.into_iter().map(Motion::Ptp).collect() }
}

fn limits_program() -> Program {
    let mut motions = Vec::new();
    for j in 0..7 {
        for to in [-70.0, 70.0, -20.0, 20.0, 0.0] {
            let mut target = [0.0; 7];
            target[j] = to;
            motions.push(Ptp::to(deg(target)));
        }
    }
    program([0.0; 7], motions)
}

fn blends_program() -> Program {
    let start = deg([0.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0]);
    let corner = deg([0.0, 40.0, 0.0, -60.0, 0.0, 0.0, 0.0]);
    let mut motions = Vec::new();
    for i in 0..36 {
        let (sin, cos) = (f64::from(i) * 10.0).to_radians().sin_cos();
        let mut end = corner;
        end[1] += 0.5 * cos;
        end[3] += 0.5 * sin;
        motions.push(Ptp::to(corner).velocity(0.5).blend(Blend::Fraction(0.25)));
        motions.push(Ptp::to(end).velocity(0.5));
        motions.push(Ptp::to(start));
    }
    program(start, motions)
}

fn settle_program(random: &mut Rng) -> Program {
    let motions = (0..40).map(|_| {
        Ptp::to(std::array::from_fn(|_| 1.5 * (random.f64() - 0.5)))
            .velocity(0.1 + 0.9 * random.f64())
    });
    program([0.0; 7], motions.collect::<Vec<_>>())
}

fn any_robot(random: &mut Rng) -> Robot {
    let mut limits = *Robot::default().limits();
    for j in 0..7 {
        let mut factor = || 0.75 + 0.55 * random.f64();
        limits.velocity_rad_s[j] *= factor();
        limits.acceleration_rad_s2[j] *= factor();
        limits.jerk_rad_s3[j] *= factor();
    }
    // kappa at 0, 90 and 180 deg.
    let [a, b, c] = [-3.97, -1.1, 6.4].map(|kappa| kappa + 3.0 * (random.f64() - 0.5));
    let c2 = (a - 2.0 * b + c) / (2.0 * 90.0 * 90.0);
    Robot::default()
        .with_limits(limits)
        .with_blend_kappa([a, (b - a) / 90.0 - 90.0 * c2, c2])
        .with_settle_time_s(0.02 + 0.08 * random.f64())
}

#[test]
fn random_robots() {
    let mut random = Rng::with_seed(1);
    let model = Robot::default();
    let mut worst = [0.0_f64; 5];
    let mut inside = [(0, 0); 5];
    for seed in 0..50 {
        let truth = any_robot(&mut random);
        let mut robot = VirtualRobot::new(truth.clone(), seed);
        robot.noise_rad = 1e-5;
        let programs = [limits_program(), blends_program(), settle_program(&mut random)];
        let logs: Vec<JointLog> =
            programs.iter().map(|program| robot.run(program).unwrap().1).collect();
        let recordings: Vec<_> =
            programs.iter().zip(&logs).map(|(program, log)| Recording { program, log }).collect();
        let found: Identified = identify(&recordings, &model).unwrap();
        if seed == 0 {
            for b in &found.blends {
                println!(
                    "{:.1} {:.4} {:.5} truth {:.4} reach {:?} {}",
                    b.gamma_deg,
                    b.kappa.0,
                    b.kappa.1,
                    truth.kappa(b.gamma_deg),
                    b.found_reach_rad,
                    b.reach_rad
                );
            }
            println!("{:?}", found.left_out);
            println!("{:?}", found.unequal_share);
            for l in &found.lines[..10] {
                println!("{:?}", l);
            }
        }
        let limits = truth.limits();
        for (k, (found, truth)) in [
            (&found.velocity_rad_s, &limits.velocity_rad_s),
            (&found.acceleration_rad_s2, &limits.acceleration_rad_s2),
            (&found.jerk_rad_s3, &limits.jerk_rad_s3),
        ]
        .into_iter()
        .enumerate()
        {
            for j in 0..7 {
                let Some(found) = found[j] else {
                    println!("{k} {j} not found");
                    continue;
                };
                let error = found.value / truth[j] - 1.0;
                worst[k] = worst[k].max(error.abs());
                inside[k].0 += usize::from(found.holds(truth[j]));
                inside[k].1 += 1;
                if seed == 0 {
                    println!(
                        "{k} {j} {error:.6} +- {:.6} n {}",
                        found.uncertainty / truth[j],
                        found.count
                    );
                }
            }
        }
        let settle = found.settle.unwrap();
        let error = settle.mean_s.value - truth.settle_time_s();
        println!(
            "settle {error:.6} +- {:.6} sd {:.6} n {}",
            settle.mean_s.uncertainty, settle.deviation_s, settle.mean_s.count
        );
        worst[3] = worst[3].max(error.abs());
        inside[3].0 += usize::from(settle.mean_s.holds(truth.settle_time_s()));
        inside[3].1 += 1;
        let kappa = found.kappa.unwrap();
        for i in 1..=17 {
            let gamma = f64::from(i) * 10.0;
            let found = kappa.at(gamma);
            let error = found.value - truth.kappa(gamma);
            worst[4] = worst[4].max(error.abs());
            inside[4].0 += usize::from(found.holds(truth.kappa(gamma)));
            inside[4].1 += 1;
        }
    }
    println!("{worst:?} {inside:?}");
}
