//! The fastest sequence of tasks: compared with all sequences, one after the other.

use iiwa_optimise::SequenceTimes;

/// Linear congruential generator: the same numbers each time.
struct Random(u64);

impl Random {
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 40) as f64 / (1_u64 << 24) as f64
    }
}

/// Times between the ends and the starts of tasks in a square. Every fourth task has to come after
/// another one.
fn random(count: usize, seed: u64) -> SequenceTimes {
    let mut random = Random(seed);
    let mut points =
        || -> Vec<[f64; 2]> { (0..count).map(|_| [random.share(), random.share()]).collect() };
    let (starts, ends) = (points(), points());
    let time = |from: &[f64; 2], to: &[f64; 2]| (from[0] - to[0]).hypot(from[1] - to[1]);
    let to_all = |from: &[f64; 2]| starts.iter().map(|start| time(from, start)).collect();
    SequenceTimes {
        first_s: to_all(&[0.0, 0.0]),
        next_s: ends.iter().map(to_all).collect(),
        last_s: ends.iter().map(|end| time(end, &[1.0, 0.0])).collect(),
        after: (0..count)
            .map(|task| if task % 4 == 3 { vec![task / 2] } else { Vec::new() })
            .collect(),
    }
}

fn given(count: usize) -> Vec<usize> {
    (0..count).collect()
}

/// Shortest time of all sequences, of which the first tasks are fixed.
fn by_trial(times: &SequenceTimes, order: &mut Vec<usize>, fixed: usize) -> f64 {
    if fixed == order.len() {
        return if times.is_allowed(order) { times.total_s(order) } else { f64::INFINITY };
    }
    let mut least_s = f64::INFINITY;
    for other in fixed..order.len() {
        order.swap(fixed, other);
        least_s = least_s.min(by_trial(times, order, fixed + 1));
        order.swap(fixed, other);
    }
    least_s
}

#[test]
fn the_dynamic_program_finds_the_fastest_of_all_sequences() {
    for count in 1..=7 {
        for seed in 0..10 {
            let times = random(count, seed);
            let order = times.fastest().unwrap();
            assert!(times.is_allowed(&order), "{order:?}");
            let least_s = by_trial(&times, &mut given(count), 0);
            assert!((times.total_s(&order) - least_s).abs() < 1e-12, "{count} {seed}");
        }
    }
}

/// With `IIWASIM_LONG`, of twenty tasks, as many as the largest whose fastest sequence is known.
#[test]
fn the_local_search_is_within_a_percent_of_the_fastest_sequence() {
    let (count, seeds) = if std::env::var_os("IIWASIM_LONG").is_some() { (20, 3) } else { (13, 6) };
    for seed in 0..seeds {
        let times = random(count, seed);
        let exact_s = times.total_s(&times.fastest().unwrap());
        let order = times.improved(&given(count)).unwrap();
        assert!(times.is_allowed(&order), "{order:?}");
        let share = times.total_s(&order) / exact_s;
        assert!((1.0 - 1e-12..=1.01).contains(&share), "{seed}: {share}");
    }
}

#[test]
fn a_sequence_of_many_tasks_is_allowed_and_faster() {
    let times = random(40, 3);
    let order = times.improved(&given(40)).unwrap();
    assert!(times.is_allowed(&order), "{order:?}");
    assert!(times.total_s(&order) < 0.5 * times.total_s(&given(40)));
    // The same sequence each time.
    assert_eq!(times.improved(&given(40)).unwrap(), order);
}

#[test]
fn an_impossible_sequence_is_none() {
    let mut times = random(3, 0);
    times.first_s = vec![f64::INFINITY; 3];
    assert_eq!(times.fastest(), None);
    assert_eq!(times.improved(&given(3)), None);
}
