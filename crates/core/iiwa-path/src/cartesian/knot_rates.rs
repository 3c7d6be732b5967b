//! Derivatives of a spline at its knots, with respect to chord length.
//!
//! With d1, d2 the chords before and after an inner knot and s1, s2 the secants (step over chord),
//! the parabola through the knot and its two direct neighbours has the derivatives
//!
//! ```text
//! m = (d2 s1 + d1 s2) / (d1 + d2)        first derivative
//! c = 2 (s2 - s1) / (d1 + d2)            second derivative
//! ```
//!
//! At an end of the spline the parabola of the adjacent knot continues: m = 2 s - m', c = +-2 (s -
//! m') / d, with m' the first derivative at the adjacent knot. Source: recordings of an LBR iiwa 7
//! R800 under Sunrise, see docs/cartesian.md.

use super::quintic::Rates;

/// A segment from the point of view of one channel of a spline: position, orientation or E1.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stretch<const N: usize> {
    /// Segment whose rates follow from the knots.
    Free {
        /// Length for the rates.
        chord: f64,
        /// Difference of both knots, relative to the first.
        step: [f64; N],
    },
    /// Segment with given rates at start and end, by arc length.
    Given([Rates<N>; 2]),
}

/// The source of the rates at one end of a free segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum RateSource<const N: usize> {
    /// The parabola through the knot and both neighbours.
    Parabola(Rates<N>),
    /// The neighbouring segment, which is not free.
    Neighbour(Rates<N>),
    /// The parabola at the other end of the segment, because the spline starts or ends here.
    End,
}

/// Derivatives of the parabola through three knots, at the middle one.
pub(crate) fn parabola<const N: usize>(
    [d1, d2]: [f64; 2],
    [before, behind]: [&[f64; N]; 2],
) -> Rates<N> {
    let secants = |i: usize| [before[i] / d1, behind[i] / d2];
    Rates {
        first: std::array::from_fn(|i| {
            let [s1, s2] = secants(i);
            (d2 * s1 + d1 * s2) / (d1 + d2)
        }),
        second: std::array::from_fn(|i| {
            let [s1, s2] = secants(i);
            2.0 * (s2 - s1) / (d1 + d2)
        }),
    }
}

/// Returns the sources of the rates at start and end of the free segment `index`.
pub(crate) fn rate_sources<const N: usize>(
    stretches: &[Stretch<N>],
    index: usize,
) -> [RateSource<N>; 2] {
    let at_knot = |before: Option<&Stretch<N>>, behind: Option<&Stretch<N>>| match (before, behind)
    {
        (
            Some(Stretch::Free { chord: d1, step: a }),
            Some(Stretch::Free { chord: d2, step: b }),
        ) => RateSource::Parabola(parabola([*d1, *d2], [a, b])),
        (Some(Stretch::Given([_, rates])), _) | (_, Some(Stretch::Given([rates, _]))) => {
            RateSource::Neighbour(*rates)
        }
        _ => RateSource::End,
    };
    let this = stretches.get(index);
    let before = index.checked_sub(1).and_then(|i| stretches.get(i));
    [at_knot(before, this), at_knot(this, stretches.get(index + 1))]
}

/// Returns the rates at both ends of a segment, each relative to its own knot. Where the spline
/// starts or ends, the argument is `None`.
///
/// `carried` converts rates relative to one end into rates relative to the other, which is `step`
/// away.
pub(crate) fn with_ends<const N: usize>(
    rates: [Option<Rates<N>>; 2],
    chord: f64,
    step: &[f64; N],
    carried: impl Fn(&[f64; N], &Rates<N>) -> Rates<N>,
) -> [Rates<N>; 2] {
    let end = |inner: &Rates<N>, sign: f64| Rates {
        first: std::array::from_fn(|i| 2.0 * step[i] / chord - inner.first[i]),
        second: std::array::from_fn(|i| sign * 2.0 * (step[i] / chord - inner.first[i]) / chord),
    };
    match rates {
        [Some(start), Some(end)] => [start, end],
        [None, Some(inner)] => [end(&carried(step, &inner), -1.0), inner],
        [Some(inner), None] => [inner, end(&carried(&step.map(|x| -x), &inner), 1.0)],
        [None, None] => [Rates::even(step, chord); 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near<const N: usize>(a: &Rates<N>, b: &Rates<N>) {
        for (a, b) in a.first.iter().chain(&a.second).zip(b.first.iter().chain(&b.second)) {
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
    }

    /// All knots on p(u) = (u + u^2, 3 - 2 u^2): p' = (1 + 2 u, -4 u), p'' = (2, -4).
    #[test]
    fn the_rates_of_a_parabola_are_found() {
        let at = |u: f64| [u + u * u, 3.0 - 2.0 * u * u];
        let step = |from: f64, to: f64| {
            let [a, b] = [at(from), at(to)];
            [b[0] - a[0], b[1] - a[1]]
        };
        let rates = |u: f64| Rates { first: [1.0 + 2.0 * u, -4.0 * u], second: [2.0, -4.0] };
        let stretches = [
            Stretch::Free { chord: 0.5, step: step(0.0, 0.5) },
            Stretch::Free { chord: 0.2, step: step(0.5, 0.7) },
        ];
        let [RateSource::End, RateSource::Parabola(middle)] = rate_sources(&stretches, 0) else {
            panic!("an end and a parabola")
        };
        near(&middle, &rates(0.5));
        let carried = |_: &[f64; 2], rates: &Rates<2>| *rates;
        let [start, _] = with_ends([None, Some(middle)], 0.5, &step(0.0, 0.5), carried);
        near(&start, &rates(0.0));
        let [_, end] = with_ends([Some(middle), None], 0.2, &step(0.5, 0.7), carried);
        near(&end, &rates(0.7));
    }

    #[test]
    fn a_segment_that_is_not_free_gives_its_rates() {
        let prescribed = [1.0, 2.0].map(|x| Rates { first: [x], second: [-x] });
        let stretches = [Stretch::Free { chord: 1.0, step: [1.0] }, Stretch::Given(prescribed)];
        assert_eq!(
            rate_sources(&stretches, 0),
            [RateSource::End, RateSource::Neighbour(prescribed[0])]
        );
    }
}
