//! Search for the start and the end of blends with a radius: time per search.
#![expect(clippy::print_stderr, reason = "where a bench says that it cannot run")]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use iiwa_kin::Robot;
use iiwa_path::BlendSearch;
use iiwasim_benches::reference;

fn blend_search(criterion: &mut Criterion) {
    let searches = match reference::searches() {
        Ok(searches) => searches,
        Err(error) => return eprintln!("{error}"),
    };
    let robot = Robot::lbr_iiwa_7_r800();
    let mut group = criterion.benchmark_group("blend search");
    group.throughput(Throughput::Elements(searches.len() as u64));
    for (name, kind) in [
        ("first crossing", BlendSearch::FirstCrossing),
        ("algorithm 1", BlendSearch::Algorithm1),
        ("algorithm 2", BlendSearch::Algorithm2),
    ] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for search in &searches {
                    black_box(black_box(search).run(kind, &robot));
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, blend_search);
criterion_main!(benches);
