//! Roots of functions that cost more than arithmetic.

/// Where a function that grows, or falls, from `least` to `most` is 0, with its values at both: the Illinois method.
///
/// The value there is at most `tolerance`, unless the two are neighbours.
pub(super) fn root(
    [mut least, mut most]: [f64; 2],
    [mut at_least, mut at_most]: [f64; 2],
    tolerance: f64,
    value: impl Fn(f64) -> f64,
) -> f64 {
    /// Doubles are used up long before.
    const MOST_STEPS: usize = 200;
    let mut last_side = 0;
    for _ in 0..MOST_STEPS {
        let middle = (least * at_most - most * at_least) / (at_most - at_least);
        let middle =
            if middle > least && middle < most { middle } else { f64::midpoint(least, most) };
        if middle <= least || middle >= most {
            break;
        }
        let found = value(middle);
        if found.abs() <= tolerance {
            return middle;
        }
        // The end that stays twice counts for half: it would stay for ever.
        let side = if found.is_sign_positive() == at_least.is_sign_positive() { -1 } else { 1 };
        if side < 0 {
            (least, at_least) = (middle, found);
            if last_side == side {
                at_most *= 0.5;
            }
        } else {
            (most, at_most) = (middle, found);
            if last_side == side {
                at_least *= 0.5;
            }
        }
        last_side = side;
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::cell::Cell;

    proptest! {
        #[test]
        fn it_finds_powers(power in 0.5..4.0_f64, at in 0.05..0.999_f64) {
            let calls = Cell::new(0);
            let value = |x: f64| { calls.set(calls.get() + 1); x.powf(power) - at.powf(power) };
            let found = root([0.0, 1.0], [value(0.0), value(1.0)], 1e-14, value);
            prop_assert!((found - at).abs() < 1e-8, "{found} {at}");
            prop_assert!(calls.get() < 60, "{}", calls.get());
        }
    }

    #[test]
    fn it_ends_between_neighbours() {
        let step = |x: f64| if x < 0.3 { 1.0 } else { -1.0 };
        let found = root([0.0, 1.0], [1.0, -1.0], 0.0, step);
        assert!((found - 0.3).abs() < 1e-15);
    }
}
