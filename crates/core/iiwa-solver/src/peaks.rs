//! Extrema of smooth curves from samples.

use crate::geometry::PlaceValues;

/// Places of a cell that are sampled, as shares of it: evenly spaced from its start to its end. The
/// last one is repeated to fill vector registers.
pub(crate) const SHARES: PlaceValues =
    [0.0, 1.0 / 6.0, 1.0 / 3.0, 0.5, 2.0 / 3.0, 5.0 / 6.0, 1.0, 1.0];

/// Largest magnitude of some curves.
#[derive(Clone, Copy, Default)]
pub(crate) struct Peak {
    largest: PlaceValues,
    /// Zero, or NaN if a sample is not finite.
    spoilt: PlaceValues,
}

impl Peak {
    /// Adds a curve sampled at [`SHARES`]: its samples, and the vertex of the parabola through
    /// three neighbouring samples.
    #[inline(always)]
    pub(crate) fn add(&mut self, samples: &PlaceValues) {
        // At both ends the missing neighbour mirrors the other one, which puts the vertex at the
        // end.
        let before = [1, 0, 1, 2, 3, 4, 5, 7].map(|i: usize| samples[i]);
        let after = [1, 2, 3, 4, 5, 6, 5, 7].map(|i: usize| samples[i]);
        for i in 0..samples.len() {
            let middle = samples[i];
            let slope = 0.5 * (after[i] - before[i]);
            let bend = after[i] - 2.0 * middle + before[i];
            let rise = if slope.abs() < bend.abs() { 0.5 * slope * slope / bend } else { 0.0 };
            let vertex = (middle - rise).abs();
            let larger = if vertex > middle.abs() { vertex } else { middle.abs() };
            self.largest[i] = if larger > self.largest[i] { larger } else { self.largest[i] };
            // 0 times a sample that is not finite is NaN, which the comparisons above would drop.
            self.spoilt[i] += 0.0 * middle;
        }
    }

    /// Largest magnitude of all curves; NaN if a sample was not finite.
    #[inline(always)]
    pub(crate) fn get(&self) -> f64 {
        // NaN is never among them.
        let largest = self.largest.into_iter().fold(0.0, |a, b| if b > a { b } else { a });
        largest + self.spoilt.into_iter().sum::<f64>()
    }
}

/// Largest error of a parabola through three neighbouring samples between these samples, exact for
/// a cubic through four samples.
pub(crate) fn parabola_error(samples: &PlaceValues) -> f64 {
    /// Largest value of `f (f - 1) (f - 2) / 6` for f from 0 to 2.
    const CUBIC: f64 = 0.064_150_029_909_958_41;
    let third = |i: usize| samples[i + 3] - samples[i] + 3.0 * (samples[i + 1] - samples[i + 2]);
    (0..4).map(|i| CUBIC * third(i).abs()).fold(0.0, larger)
}

/// Returns the larger number, or NaN if either is NaN.
#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peak(curve: impl Fn(f64) -> f64) -> f64 {
        let mut peak = Peak::default();
        peak.add(&SHARES.map(curve));
        peak.get()
    }

    #[test]
    fn is_found_between_samples_and_at_ends() {
        assert!((peak(|x| 1.0 - (x - 0.3).powi(2)) - 1.0).abs() < 1e-15);
        assert_eq!(peak(|x| x), 1.0);
        assert_eq!(peak(|x| -x * x), 1.0);
        assert_eq!(peak(|x| 1.0 - x), 1.0);
        assert!(peak(|x| if x == 0.5 { f64::NAN } else { x }).is_nan());
        assert!(peak(|x| 1.0 / x).is_nan());
    }

    #[test]
    fn a_parabola_misses_the_peak_of_a_cubic() {
        let samples = |curve: fn(f64) -> f64| SHARES.map(curve);
        assert!(parabola_error(&samples(|x| 3.0 + x * (2.0 - 5.0 * x))) < 1e-15);
        // Between the shares 0 and 1/6: x^3 less the parabola through its values at 0, 1/6 and 1/3.
        let error = |x: f64| x * (x - 1.0 / 6.0) * (x - 1.0 / 3.0);
        let largest = (0..=1000).map(|i| error(f64::from(i) / 6000.0)).fold(0.0, f64::max);
        assert!((parabola_error(&samples(|x| x * x * x)) / largest - 1.0).abs() < 1e-5);
    }

    #[test]
    fn is_that_of_the_largest_curve() {
        let mut peak = Peak::default();
        peak.add(&SHARES.map(|x| x - 3.0));
        peak.add(&SHARES.map(|x| 2.0 * x));
        assert_eq!(peak.get(), 3.0);
    }
}
