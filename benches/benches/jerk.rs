//! Time parameterisation with jerk limits: for a program of ten blended motions, the first
//! reference program, and for longer ones.
#![expect(clippy::print_stderr, reason = "where a bench says what it cannot time")]

use std::{
    hint::black_box,
    time::{Duration, Instant},
};

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{Timing, Trajectory};
use iiwasim_benches::{
    Result,
    long_program::{Kind, text},
    reference,
    topp3::{JerkSamples, PEERS},
};

fn jerk(criterion: &mut Criterion) {
    if let Err(error) = against_peers(criterion).and_then(|()| growth(criterion)) {
        eprintln!("{error}");
    }
}

fn against_peers(criterion: &mut Criterion) -> Result<()> {
    let program = Program::from_json(&reference::ten_motions()?)?;
    let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800())?;
    let timing = Timing::jerk_limited();

    let mut group = criterion.benchmark_group("stamps, jerk");
    group.throughput(Throughput::Elements(program.motions.len() as u64));
    let ours_s = Trajectory::plan(&path, timing)?.motion_time_s();
    eprintln!("stamps, jerk/iiwa-traj plan: {ours_s:.6} s in motion");
    group.bench_function("iiwa-traj plan", |bencher| {
        bencher.iter(|| Trajectory::plan(black_box(&path), timing));
    });
    // The peer takes seconds: one solution per sample. Fast benches must precede these settings.
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_millis(1)).measurement_time(Duration::from_secs(1));
    for peer in PEERS.iter().filter(|peer| peer.timed) {
        let samples = JerkSamples::new(&path, peer.intervals)?;
        // Solved once beforehand: a failing solver would appear to be fast.
        let theirs_s = samples.solve(peer.solver)?.duration_s;
        eprintln!("stamps, jerk/{}: {theirs_s:.6} s in motion", peer.name);
        group.bench_function(peer.name, |bencher| {
            bencher.iter(|| black_box(&samples).solve(peer.solver));
        });
    }
    group.finish();
    Ok(())
}

/// Longest sampled time of one plan: ten samples of a slower plan take too long.
const MAX_DURATION: Duration = Duration::from_secs(3);

/// Programs without a stop are planned as a whole: their time should grow at most linearly.
fn growth(criterion: &mut Criterion) -> Result<()> {
    let mut group = criterion.benchmark_group("growth, jerk");
    // The longest program takes seconds.
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for motions in [10, 100, 1000] {
        let program = Program::from_json(&text(Kind::Blended, motions))?;
        let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800())?;
        let timing = Timing::jerk_limited();
        let start = Instant::now();
        Trajectory::plan(&path, timing)?;
        let once = start.elapsed();
        if once > MAX_DURATION {
            let once_s = once.as_secs_f64();
            eprintln!("growth, jerk/{motions} motions: not sampled, one plan takes {once_s:.1} s");
            continue;
        }
        group.throughput(Throughput::Elements(motions as u64));
        group.bench_function(format!("{motions} motions"), |bencher| {
            bencher.iter(|| Trajectory::plan(black_box(&path), timing));
        });
    }
    group.finish();
    Ok(())
}

criterion_group!(benches, jerk);
criterion_main!(benches);
