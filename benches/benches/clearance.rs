//! Clearances of the arm in a cell with ten obstacles: of poses, and of the ten motions.
#![expect(clippy::print_stderr, reason = "where a bench says that it cannot run")]

use std::{fs, hint::black_box};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_scene::{ArmInScene, Scene};
use iiwa_traj::{Timing, Trajectory};
use iiwasim_benches::{Result, joints::poses, reference};

const POSES: usize = 1024;

fn clearance(criterion: &mut Criterion) {
    if let Err(error) = run(criterion) {
        eprintln!("{error}");
    }
}

fn run(criterion: &mut Criterion) -> Result<()> {
    let robot = Robot::lbr_iiwa_7_r800();
    let cage = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/cage.json");
    let scene = Scene::from_json(&fs::read_to_string(cage)?)?;
    let arm = ArmInScene::new(&robot, &scene);
    let program = Program::from_json(&reference::ten_motions()?)?;
    let trajectory = Trajectory::plan(&JointPath::new(&program, &robot)?, Timing::default())?;

    let mut group = criterion.benchmark_group("clearance");
    let joints = poses(&robot, POSES);
    group.throughput(Throughput::Elements(POSES as u64));
    group.bench_function("poses all over the ranges", |bencher| {
        bencher.iter(|| {
            for q in &joints {
                black_box(arm.clearance(black_box(q)));
            }
        });
    });
    let steps = POSES as f64;
    let along: Vec<_> =
        (0..POSES).map(|i| trajectory.at(trajectory.cycle_time_s() * i as f64 / steps).q).collect();
    group.bench_function("poses of the ten motions", |bencher| {
        bencher.iter(|| {
            for q in &along {
                black_box(arm.clearance(black_box(q)));
            }
        });
    });
    group.finish();

    let mut group = criterion.benchmark_group("planned clearance");
    group.bench_function("ten motions", |bencher| {
        bencher.iter(|| black_box(arm.clearance_of(black_box(&trajectory))));
    });
    group.bench_function("each of the ten motions", |bencher| {
        bencher.iter(|| {
            for section in trajectory.sections() {
                black_box(arm.clearances(black_box(section)));
            }
        });
    });
    group.finish();
    Ok(())
}

criterion_group!(benches, clearance);
criterion_main!(benches);
