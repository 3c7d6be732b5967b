//! Inverse of `s + alpha(s)`, the parameter along a blend, for each order of continuity.

use std::sync::OnceLock;

use iiwa_kin::hermite;

use crate::continuity::{Continuity, Polynomial};

/// Number of intervals of the table. With cubic interpolation the first guess has an error of at
/// most 1e-8, which one Newton step reduces to rounding.
const INTERVALS: usize = 512;

/// s and ds/dsigma at evenly spaced sigma from 0 to 2.
type Table = [[f64; 2]; INTERVALS + 1];

/// Returns the s in [0, 1] at which `s + alpha(s)` is `sigma`, in [0, 2].
pub(crate) fn s_at(continuity: Continuity, sigma: f64) -> f64 {
    let [s] = each_s_at(continuity, [sigma]);
    s
}

/// Returns s at several values of sigma. Only the table look-up is not vectorised.
#[inline(always)]
pub(crate) fn each_s_at<const N: usize>(continuity: Continuity, sigma: [f64; N]) -> [f64; N] {
    static TABLES: [OnceLock<Box<Table>>; 3] = [const { OnceLock::new() }; 3];
    let along = continuity.along();
    let table = TABLES[continuity as usize].get_or_init(|| table(&along));
    let mut s = sigma.map(|sigma| interpolated(table, sigma));
    for i in 0..N {
        s[i] = newton(&along, sigma[i], s[i]);
    }
    s
}

/// s by interpolation in the table.
#[inline(always)]
fn interpolated(table: &Table, sigma: f64) -> f64 {
    let place = (sigma * (INTERVALS as f64 / 2.0)).clamp(0.0, INTERVALS as f64);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "it is between 0 and the number of intervals; what is not a number becomes 0"
    )]
    // The end of the table belongs to the last interval.
    let index = (place as usize).min(INTERVALS - 1);
    let f = place - index as f64;
    let [[a, da], [b, db]] = [table[index], table[index + 1]];
    let h = 2.0 / INTERVALS as f64;
    hermite::value(&hermite::cubic([a, da * h], [b, db * h]), f)
}

/// One Newton step.
#[inline(always)]
fn newton(along: &Polynomial, sigma: f64, s: f64) -> f64 {
    let (mut value, mut slope) = (0.0, 0.0);
    for c in along.iter().rev() {
        slope = slope * s + value;
        value = value * s + c;
    }
    // The slope is at least 1, because alpha does not decrease.
    (s - (value - sigma) / slope).clamp(0.0, 1.0)
}

fn table(along: &Polynomial) -> Box<Table> {
    let slope = |s: f64| {
        along
            .iter()
            .zip(0..9)
            .skip(1)
            .fold(0.0, |sum, (c, n)| sum + f64::from(n) * c * s.powi(n - 1))
    };
    let mut table = Box::new([[0.0, 1.0]; INTERVALS + 1]);
    let mut s = 0.0;
    for (i, row) in table.iter_mut().enumerate() {
        let sigma = 2.0 * i as f64 / INTERVALS as f64;
        // The value before is a close first guess.
        for _ in 0..8 {
            s = newton(along, sigma, s);
        }
        *row = [s, 1.0 / slope(s)];
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuity::evaluate;

    #[test]
    fn is_the_inverse() {
        for continuity in [Continuity::First, Continuity::Second, Continuity::Third] {
            for i in 0..=10_000 {
                let sigma = 2.0 * f64::from(i) / 10_000.0;
                let [value, slope, ..] = evaluate(&continuity.along(), s_at(continuity, sigma));
                assert!((value - sigma).abs() <= 3e-14 * slope, "{continuity:?} {sigma}");
            }
            assert_eq!([s_at(continuity, 0.0), s_at(continuity, 2.0)], [0.0, 1.0]);
            assert_eq!([s_at(continuity, -1.0), s_at(continuity, 3.0)], [0.0, 1.0]);
        }
    }
}
