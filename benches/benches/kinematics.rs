//! Forward and inverse kinematics: time per pose.
#![expect(clippy::print_stderr, reason = "where a bench says that it cannot run")]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use iiwa_kin::{Joints, MovingPose, Pose, Robot, Status, Taylor};
use iiwasim_benches::{dh_product::DhProduct, joints::poses, urdf_chain::UrdfChain};

const POSES: usize = 1024;

fn forward(criterion: &mut Criterion) {
    let robot = Robot::lbr_iiwa_7_r800();
    let joints = poses(&robot, POSES);
    let mut group = criterion.benchmark_group("forward kinematics");
    group.throughput(Throughput::Elements(POSES as u64));

    let mut each = |name: &str, run: &dyn Fn(&Joints)| {
        group.bench_function(name, |bencher| bencher.iter(|| joints.iter().for_each(run)));
    };
    each("iiwa-kin tcp", &|q| {
        black_box(robot.flange_pose(black_box(q)));
    });
    each("iiwa-kin tcp_position", &|q| {
        black_box(robot.flange_position(black_box(q)));
    });
    each("seven std sin_cos alone", &|q| {
        black_box(black_box(q).map(f64::sin_cos));
    });
    let product = DhProduct::new(&robot);
    each("nalgebra 4x4 DH product", &|q| {
        black_box(product.flange_pose(black_box(q)));
    });
    match UrdfChain::new(&robot) {
        Ok(chain) => each("k", &|q| {
            black_box(chain.flange_pose(black_box(q)));
        }),
        Err(error) => eprintln!("k: {error}"),
    }

    let mut poses = vec![Pose::IDENTITY; POSES];
    group.bench_function("iiwa-kin tcp_batch", |bencher| {
        bencher.iter(|| robot.flange_pose_batch(black_box(&joints), black_box(&mut poses)));
    });
    group.finish();
}

fn inverse(criterion: &mut Criterion) {
    let robot = Robot::lbr_iiwa_7_r800();
    let targets: Vec<(Pose, MovingPose, f64, Status)> = poses(&robot, POSES)
        .iter()
        .map(|q| {
            let flange = robot.flange_pose(q);
            // A straight line with a constant orientation: arithmetic with zeros takes the same
            // time.
            let mut moving = MovingPose::constant(&flange);
            moving.position_m[0].0[1] = 0.2;
            (flange, moving, q[2], Status::of(&robot, q))
        })
        .collect();
    let mut group = criterion.benchmark_group("inverse kinematics");
    group.throughput(Throughput::Elements(POSES as u64));
    group.bench_function("iiwa-kin inverse", |bencher| {
        bencher.iter(|| {
            for (flange, _, e1_rad, status) in &targets {
                let _ = black_box(robot.inverse(black_box(flange), *e1_rad, *status));
            }
        });
    });
    group.bench_function("iiwa-kin inverse_moving", |bencher| {
        bencher.iter(|| {
            for (_, moving, e1_rad, status) in &targets {
                let e1 = Taylor::constant(*e1_rad);
                let _ = black_box(robot.inverse_moving(black_box(moving), e1, *status));
            }
        });
    });
    group.finish();
}

criterion_group!(benches, forward, inverse);
criterion_main!(benches);
