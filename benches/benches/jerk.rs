//! Time stamps under limits of jerk for a program of ten blended motions: the first reference
//! program.
#![expect(clippy::print_stderr, reason = "where a bench says that it cannot run")]

use std::{hint::black_box, time::Duration};

use criterion::{
    BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main,
};
use iiwa_kin::Robot;
use iiwa_path::{Path, Program};
use iiwa_traj::SweepOptions;
use iiwasim_benches::{
    Result, reference,
    topp3::{Samples, Solver},
};

/// Few intervals a segment: the peer takes half a second for these.
const FEW: usize = 20;

fn jerk(criterion: &mut Criterion) {
    if let Err(error) = run(criterion) {
        eprintln!("{error}");
    }
}

fn run(criterion: &mut Criterion) -> Result<()> {
    let program = Program::from_json(&reference::ten_motions()?)?;
    let path = Path::new(&program, &Robot::lbr_iiwa_7_r800())?;

    let mut group = criterion.benchmark_group("stamps, jerk");
    // The peer takes seconds: one solution a sample. Whatever is fast goes before these settings.
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_millis(1)).measurement_time(Duration::from_secs(1));
    for intervals in [FEW, SweepOptions::default().samples] {
        let samples = Samples::new(&path, intervals)?;
        group.throughput(Throughput::Elements(samples.nodes() as u64));
        for (name, solver) in
            [("copp topp3_lp", Solver::Linear), ("copp topp3_socp", Solver::Conic)]
        {
            // Once beforehand: a solver that fails would fail fast.
            samples.solve(solver)?;
            group.bench_function(BenchmarkId::new(name, intervals), |bencher| {
                bencher.iter(|| black_box(&samples).solve(solver));
            });
        }
    }
    group.finish();
    Ok(())
}

criterion_group!(benches, jerk);
criterion_main!(benches);
