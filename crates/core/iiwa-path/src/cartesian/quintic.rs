//! Quintic Hermite polynomials between two knots.

use iiwa_kin::{Taylor, hermite};

/// First and second derivative of a vector by a length or an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rates<const N: usize> {
    pub(crate) first: [f64; N],
    pub(crate) second: [f64; N],
}

impl<const N: usize> Rates<N> {
    pub(crate) const ZERO: Self = Self { first: [0.0; N], second: [0.0; N] };

    /// Returns constant rates that cover `step` in `length`.
    pub(crate) fn even(step: &[f64; N], length: f64) -> Self {
        Self { first: step.map(|x| x / length), second: [0.0; N] }
    }
}

/// A polynomial of degree 5 in the share of an interval, lowest power first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quintic<const N: usize>(pub(crate) [[f64; N]; 6]);

impl<const N: usize> Quintic<N> {
    /// Returns the polynomial with the given values and rates at both ends of an interval of
    /// `length`.
    pub(crate) fn hermite(values: [&[f64; N]; 2], rates: [&Rates<N>; 2], length: f64) -> Self {
        let mut powers = [[0.0; N]; 6];
        for i in 0..N {
            let end = |k: usize| {
                let Rates { first, second } = rates[k];
                [values[k][i], length * first[i], length * length * second[i]]
            };
            let column = hermite::quintic(end(0), end(1));
            for (power, value) in powers.iter_mut().zip(column) {
                power[i] = value;
            }
        }
        Self(powers)
    }

    pub(crate) fn at(&self, x: Taylor) -> [Taylor; N] {
        std::array::from_fn(|i| {
            let [rest @ .., highest] = &self.0;
            let highest = Taylor::constant(highest[i]);
            rest.iter().rev().fold(highest, |sum, power| sum * x + Taylor::constant(power[i]))
        })
    }

    /// Value, first and second derivative with respect to the share.
    pub(crate) fn derivatives(&self, x: f64) -> [[f64; N]; 3] {
        let series = self.at(Taylor::variable(x)).map(Taylor::derivatives);
        std::array::from_fn(|order| series.map(|derivatives| derivatives[order]))
    }

    /// Reparameterises the curve to a part of its interval, in reverse if `to` is below `from`.
    pub(crate) fn part(&self, [from, to]: [f64; 2]) -> Self {
        Self(powers_within(self.0, [from, to]))
    }
}

/// Coefficients of polynomials, lowest power first, in the share of a part of their interval.
pub(crate) fn powers_within<const N: usize, const COUNT: usize>(
    mut powers: [[f64; N]; COUNT],
    [from, to]: [f64; 2],
) -> [[f64; N]; COUNT] {
    // Repeated synthetic division by x - from gives the powers of x - from. Then x - from = (to -
    // from) share.
    for lowest in 0..COUNT - 1 {
        for k in (lowest..COUNT - 1).rev() {
            let higher = powers[k + 1];
            for (power, higher) in powers[k].iter_mut().zip(higher) {
                *power += from * higher;
            }
        }
    }
    let mut scale = 1.0;
    for power in &mut powers {
        *power = power.map(|x| x * scale);
        scale *= to - from;
    }
    powers
}

/// A quantity along a path: a polynomial in a share w, which is itself a polynomial in the share s
/// of the arc length.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Linked<const N: usize> {
    /// w by s; `None` if w is s.
    link: Option<Quintic<1>>,
    /// Coefficients of the powers of w, without trailing zeros.
    powers: Vec<[f64; N]>,
}

impl<const N: usize> Linked<N> {
    pub(crate) fn new(link: Option<Quintic<1>>, mut powers: Vec<[f64; N]>) -> Self {
        // Without trailing zeros, `is_zero` and `linear` recognise simple cases by the length.
        let len = powers.iter().rposition(|power| *power != [0.0; N]).map_or(0, |last| last + 1);
        powers.truncate(len);
        Self { link, powers }
    }

    /// Returns a quantity that changes linearly in s.
    pub(crate) fn even(from: [f64; N], to: [f64; N]) -> Self {
        let by = std::array::from_fn(|i| to[i] - from[i]);
        Self::new(None, vec![from, by])
    }

    /// Returns the quantity plus `value`.
    pub(crate) fn plus(mut self, value: &[f64; N]) -> Self {
        match self.powers.first_mut() {
            Some(power) => *power = std::array::from_fn(|i| power[i] + value[i]),
            None => self.powers.push(*value),
        }
        self
    }

    pub(crate) fn at(&self, s: Taylor) -> [Taylor; N] {
        let w = match &self.link {
            Some(link) => link.at(s)[0],
            None => s,
        };
        std::array::from_fn(|i| {
            let mut descending = self.powers.iter().rev().map(|power| power[i]);
            let highest = Taylor::constant(descending.next().unwrap_or(0.0));
            descending.fold(highest, |sum, c| sum * w + Taylor::constant(c))
        })
    }

    /// Returns the quantity over the part `range` of s.
    pub(crate) fn part(&self, range: [f64; 2]) -> Self {
        let mut identity = [[0.0]; 6];
        identity[1] = [1.0];
        let link = self.link.unwrap_or(Quintic(identity));
        Self { link: Some(link.part(range)), powers: self.powers.clone() }
    }

    /// True if the quantity is zero everywhere.
    pub(crate) fn is_zero(&self) -> bool {
        self.powers.is_empty()
    }

    /// Value at s = 0 and rate by s, if the quantity is linear in s.
    pub(crate) fn linear(&self) -> Option<[[f64; N]; 2]> {
        match (&self.link, self.powers.as_slice()) {
            (None, []) => Some([[0.0; N]; 2]),
            (None, [from]) => Some([*from, [0.0; N]]),
            (None, [from, by]) => Some([*from, *by]),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// p(0) = 1, p' = 2, p'' = 3 at 0; p(2) = 4, p' = -1, p'' = 5 at 2. Coefficients by solving the
    /// six equations: in x = u / 2: 1, 4, 6, then the system [1 1 1; 3 4 5; 6 12 20] (c3 c4 c5) =
    /// (-7, -18, 8).
    #[test]
    fn hermite_meets_values_and_rates() {
        let rates = [Rates { first: [2.0], second: [3.0] }, Rates { first: [-1.0], second: [5.0] }];
        let curve = Quintic::hermite([&[1.0], &[4.0]], [&rates[0], &rates[1]], 2.0);
        assert_eq!(curve.0, [[1.0], [4.0], [6.0], [6.0], [-29.0], [16.0]]);
        for (x, value, rates) in [(0.0, 1.0, &rates[0]), (1.0, 4.0, &rates[1])] {
            let [p, one, two] = curve.derivatives(x);
            assert_eq!(
                [p[0], one[0] / 2.0, two[0] / 4.0],
                [value, rates.first[0], rates.second[0]]
            );
        }
    }

    #[test]
    fn parts_are_the_same_curve() {
        let curve = Quintic([[1.0], [-2.0], [0.5], [3.0], [-1.5], [0.25]]);
        for [from, to] in [[0.2, 0.7], [1.0, 0.0], [0.5, 1.0]] {
            let part = curve.part([from, to]);
            for i in 0..=10 {
                let x = f64::from(i) / 10.0;
                let [[expected], ..] = curve.derivatives(from + x * (to - from));
                let [[actual], ..] = part.derivatives(x);
                assert!((actual - expected).abs() < 1e-14);
            }
        }
    }
}
