//! Bounds with different values for both directions, compared with exhaustive trial.

use super::*;

/// Creates a node at which each joint has its own lower and upper limit: u is at most
/// `(upper - c x) / m`.
fn node(random: &mut fastrand::Rng) -> Bounds<1> {
    let unlimited = [[UNLIMITED; 8]];
    let mut bounds =
        Bounds { cap: UNLIMITED, below: unlimited, above: unlimited, ..Bounds::default() };
    for j in 0..7 {
        let (m, c) = (0.1 + random.f64(), 2.0 * random.f64() - 1.0);
        let [lower, upper] = [0.2 + random.f64(), 0.2 + random.f64()];
        (bounds.rise[0][j], bounds.above[0][j]) = (-c / m, upper / m);
        (bounds.fall[0][j], bounds.below[0][j]) = (c / m, lower / m);
    }
    bounds
}

/// Returns the smallest and the largest u at `x`, joint by joint.
fn band(bounds: &Bounds<1>, x: f64) -> [f64; 2] {
    (0..7).fold([f64::NEG_INFINITY, f64::INFINITY], |[lower, upper], j| {
        let low = -(bounds.fall[0][j] * x + bounds.below[0][j]);
        [lower.max(low), upper.min(bounds.rise[0][j] * x + bounds.above[0][j])]
    })
}

/// Step between trial values of x, from 0 to 4.
const STEP: f64 = 1e-4;

fn tried() -> impl DoubleEndedIterator<Item = f64> {
    (0..=40_000).map(|i| f64::from(i) * STEP)
}

/// Returns true if u at both ends, independent or equal, leads from `x` to `y`.
fn reaches(interval: &Interval<'_, 1>, x: f64, y: f64) -> bool {
    let (start, end) = (band(interval.start, x), band(interval.end, y));
    let sum = (y - x) / interval.h;
    if interval.even {
        let u = 0.5 * sum;
        [start, end].iter().all(|[lower, upper]| (*lower..=*upper).contains(&u))
    } else {
        let possible = start[0] <= start[1] && end[0] <= end[1];
        possible && (start[0] + end[0]..=start[1] + end[1]).contains(&sum)
    }
}

#[test]
fn largest_possible_x() {
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..30 {
        let bounds = node(&mut random);
        let actual = bounds.possible(pulp::Scalar::new(), 4.0, &mut [0; 2]);
        let expected = tried().rfind(|x| {
            let [lower, upper] = band(&bounds, *x);
            lower <= upper
        });
        let expected = expected.unwrap();
        assert!((-1e-9..=STEP).contains(&(actual - expected)), "{actual}, by trial {expected}");
        let [lower, upper] = band(&bounds, 0.5 * actual);
        assert!((bounds.u_min(pulp::Scalar::new(), 0.5 * actual) - lower).abs() < 1e-12);
        assert!((bounds.u_max(pulp::Scalar::new(), 0.5 * actual) - upper).abs() < 1e-12);
    }
}

#[test]
fn reachable_speeds_of_an_interval() {
    let mut random = fastrand::Rng::with_seed(2);
    let (mut asymmetric, mut slower) = (0, 0);
    for round in 0..60 {
        let [start, end] = [node(&mut random), node(&mut random)];
        let (h, even) = (0.05 + 0.3 * random.f64(), round % 2 == 0);
        let interval = Interval { h, even, start: &start, end: &end };
        let possible = |node: &Bounds<1>| node.possible(pulp::Scalar::new(), 4.0, &mut [0; 2]);
        let (x, cap) = (random.f64() * possible(&start), possible(&end));
        let (low, high) = interval.reachable(x, cap);
        let mut reached = tried().filter(|y| *y <= cap && reaches(&interval, x, *y));
        if let Some(first) = reached.next() {
            let last = reached.next_back().unwrap_or(first);
            assert!((low - first).abs() <= STEP && (high - last).abs() <= STEP, "{low} to {high}");
        } else {
            assert!(high - low < STEP, "{low} to {high}");
        }
        asymmetric += usize::from(start.below != start.above);

        // Backward pass: the largest x from which some x up to `end` is reachable.
        let end = random.f64() * cap;
        let actual = interval.search(end, possible(&start));
        let fits = |x: f64| {
            let (low, high) = interval.reachable(x, end);
            low <= high
        };
        let expected = tried().rfind(|x| *x <= possible(&start) && fits(*x)).unwrap_or(0.0);
        assert!((actual - expected).abs() <= 2.0 * STEP, "{actual}, by trial {expected}");
        slower += usize::from(actual < possible(&start) - STEP);
    }
    assert!(asymmetric == 60 && slower > 10, "{slower}");
}

#[test]
fn a_share_of_both_sides() {
    let before = node(&mut fastrand::Rng::with_seed(3));
    let mut bounds = Bounds { share: 1.0, ..before };
    bounds.lower(0.5);
    for j in 0..8 {
        assert_eq!(
            [bounds.below[0][j], bounds.above[0][j]],
            [before.below[0][j], before.above[0][j]].map(|v| 0.5 * v)
        );
    }
}
