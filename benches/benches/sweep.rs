//! Acceleration-limited time parameterisation of a program of ten blended motions: the first
//! reference program.
#![expect(clippy::print_stderr, reason = "where a bench says that it cannot run")]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{SweepOptions, Timing, Trajectory};
use iiwasim_benches::{
    Result,
    long_program::{Kind, text},
    reference,
    topp_ra::AccelerationSamples,
};

fn sweep(criterion: &mut Criterion) {
    if let Err(error) = run(criterion) {
        eprintln!("{error}");
    }
}

/// Number of sweep nodes: lines need none.
fn swept(path: &JointPath) -> u64 {
    let curved = path.blends().filter(|(_, segment)| !segment.is_straight());
    (curved.count() * (SweepOptions::default().samples + 1)) as u64
}

fn run(criterion: &mut Criterion) -> Result<()> {
    let robot = Robot::lbr_iiwa_7_r800();
    let ten = reference::ten_motions()?;
    let program = Program::from_json(&ten)?;
    let path = JointPath::new(&program, &robot)?;
    let long_path = JointPath::new(&Program::from_json(&text(Kind::Stops, 1000))?, &robot)?;
    let samples = AccelerationSamples::new(&path, SweepOptions::default().samples)?;
    let problem = samples.problem()?;

    let mut group = criterion.benchmark_group("stamps");
    group.throughput(Throughput::Elements(swept(&path)));
    group.bench_function("iiwa-traj plan", |bencher| {
        bencher.iter(|| {
            Trajectory::plan(black_box(&path), Timing::Acceleration(SweepOptions::default()))
        });
    });
    group.throughput(Throughput::Elements(swept(&long_path)));
    group.bench_function("iiwa-traj plan, 1000 motions", |bencher| {
        bencher.iter(|| {
            Trajectory::plan(black_box(&long_path), Timing::Acceleration(SweepOptions::default()))
        });
    });
    group.throughput(Throughput::Elements(samples.nodes() as u64));
    group.bench_function("copp topp2_ra, solver alone", |bencher| {
        bencher.iter(|| black_box(&problem).solve());
    });
    group.bench_function("copp topp2_ra, from samples", |bencher| {
        bencher.iter(|| black_box(&samples).problem().and_then(|problem| problem.solve()));
    });
    group.bench_function("copp topp2_ra, from the path", |bencher| {
        bencher.iter(|| {
            let samples =
                AccelerationSamples::new(black_box(&path), SweepOptions::default().samples)?;
            Ok::<_, Box<dyn std::error::Error>>(samples.problem()?.solve()?)
        });
    });
    group.finish();

    let mut group = criterion.benchmark_group("ten motions");
    group.bench_function("Program::from_json", |bencher| {
        bencher.iter(|| Program::from_json(black_box(&ten)));
    });
    group.bench_function("Path::new", |bencher| {
        bencher.iter(|| JointPath::new(black_box(&program), &robot));
    });
    group.bench_function("Trajectory::plan", |bencher| {
        bencher.iter(|| {
            Trajectory::plan(black_box(&path), Timing::Acceleration(SweepOptions::default()))
        });
    });
    group.finish();
    Ok(())
}

criterion_group!(benches, sweep);
criterion_main!(benches);
