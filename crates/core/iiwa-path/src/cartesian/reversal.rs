//! Reversals of the TCP direction on a spline.

use iiwa_kin::rotation::{dot, norm};

use super::{
    chord_curve::{CUSP_RATE, ChordCurve, Cusp},
    quintic::{Quintic, Rates},
};

/// Magnitude of the first derivative with respect to chord length below which the TCP reverses: in
/// recordings, it did not stop at 0.176.
const REVERSAL: f64 = 1e-3;

/// Share of the chord next to a reversal at a knot in which a second reversal is rounding.
const AT_END: f64 = 0.01;

/// Returns the rates at a knot, with a first derivative of exactly zero where the TCP reverses.
pub(crate) fn with_reversal(rates: Rates<3>) -> Rates<3> {
    let first = if norm(&rates.first) < REVERSAL { [0.0; 3] } else { rates.first };
    Rates { first, ..rates }
}

/// A part of a segment of the position.
#[derive(Clone, Debug)]
pub(crate) struct PositionPart {
    pub(crate) curve: ChordCurve,
    /// Range of the path parameter by chord length, in m: the derivatives by it continue in the
    /// next part.
    pub(crate) range_m: f64,
    /// True if the TCP reverses at the end of the part.
    pub(crate) stops: bool,
}

/// Returns the parts of a segment whose `curve` is given by the share of its chord of length
/// `chord_m`. There is one part, unless the TCP reverses within the segment or at both ends. The
/// flags are `true` at ends at which the TCP reverses.
pub(crate) fn parts(
    curve: &Quintic<3>,
    chord_m: f64,
    [starts_at_cusp, ends_at_cusp]: [bool; 2],
) -> Vec<PositionPart> {
    // Places, each with a flag that the TCP reverses there.
    let mut breaks = vec![(0.0, starts_at_cusp)];
    let is_inner = |x: &f64| !(starts_at_cusp && *x < AT_END || ends_at_cusp && *x > 1.0 - AT_END);
    breaks.extend(reversals(curve, chord_m).into_iter().filter(is_inner).map(|x| (x, true)));
    breaks.push((1.0, ends_at_cusp));
    let mut parts = Vec::new();
    for ends in breaks.windows(2) {
        let [(from, starts_at_cusp), (to, ends_at_cusp)] = [ends[0], ends[1]];
        match [starts_at_cusp, ends_at_cusp] {
            [true, true] => {
                // A `ChordCurve` has one cusp at most: two halves, without a stop between them.
                let whole = between(curve, [from, to], [true, true]);
                for (range, cusp) in [([0.0, 0.5], Cusp::Start), ([0.5, 1.0], Cusp::End)] {
                    let curve = ChordCurve::new(whole.part(range), Some(cusp));
                    let range_m = 0.5 * CUSP_RATE * (to - from) * chord_m;
                    parts.push(PositionPart { curve, range_m, stops: cusp == Cusp::End });
                }
            }
            [starts, ends] => {
                let cusp = if starts { Some(Cusp::Start) } else { ends.then_some(Cusp::End) };
                let curve = ChordCurve::new(between(curve, [from, to], [starts, ends]), cusp);
                let rate = if cusp.is_some() { CUSP_RATE } else { 1.0 };
                let range_m = rate * (to - from) * chord_m;
                parts.push(PositionPart { curve, range_m, stops: ends });
            }
        }
    }
    parts
}

/// Returns the curve between two shares of the chord, with first derivatives of exactly zero where
/// it reverses.
fn between(curve: &Quintic<3>, [from, to]: [f64; 2], cusps: [bool; 2]) -> Quintic<3> {
    // Not recomputed, so that the rates at the knots remain exact.
    if [from, to] == [0.0, 1.0] {
        return *curve;
    }
    let part = curve.part([from, to]);
    let ends = [0.0, 1.0].map(|x| part.derivatives(x));
    let rates = [0, 1].map(|i| {
        let [_, first, second] = ends[i];
        Rates { first: if cusps[i] { [0.0; 3] } else { first }, second }
    });
    Quintic::hermite([&ends[0][0], &ends[1][0]], [&rates[0], &rates[1]], 1.0)
}

/// Shares of the chord, between both ends, at which the TCP reverses: minima of the speed close to
/// zero.
fn reversals(curve: &Quintic<3>, chord_m: f64) -> Vec<f64> {
    /// The squared speed is a polynomial of degree 8, with up to 4 minima.
    const SAMPLES: u32 = 64;
    const HALVINGS: u32 = 50;
    // Half the derivative of the squared speed.
    let slope = |x: f64| {
        let [_, one, two] = curve.derivatives(x);
        dot(&one, &two)
    };
    let at = |i: u32| f64::from(i) / f64::from(SAMPLES);
    let mut reversals = Vec::new();
    for i in 0..SAMPLES {
        let [mut low, mut high] = [at(i), at(i + 1)];
        // Only minima of the speed: its slope changes from negative to positive.
        if !(slope(low) < 0.0 && slope(high) >= 0.0) {
            continue;
        }
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if slope(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let [_, speed, _] = curve.derivatives(high);
        if high < 1.0 && norm(&speed) < REVERSAL * chord_m {
            reversals.push(high);
        }
    }
    reversals
}

#[cfg(test)]
mod tests {
    use iiwa_kin::Taylor;

    use super::*;

    /// p(u) = 2 u - u^2 / 0.75 reverses at u = 0.75, where p = 0.75, and ends at 2/3.
    #[test]
    fn a_turn_on_a_line_is_a_stop() {
        let mut powers = [[0.0; 3]; 6];
        (powers[1][0], powers[2][0]) = (2.0, -2.0 / 1.5);
        let curve = Quintic(powers);
        let parts = parts(&curve, 1.0, [false; 2]);
        let [forth, back] = parts.as_slice() else { panic!("two parts") };
        assert!(forth.stops && !back.stops);
        assert!((forth.curve.length_m() - 0.75).abs() < 1e-12);
        assert!((back.curve.length_m() - (0.75 - (2.0 - 2.0 / 1.5))).abs() < 1e-12);
        let [end, ..] = forth.curve.at(Taylor::constant(1.0));
        assert!((end.0[0] - 0.75).abs() < 1e-12);
    }

    /// p = 3 u^2 - 2 u^3 is at rest at both ends: two parts without a stop in between.
    #[test]
    fn between_two_reversals_the_segment_is_halved() {
        let mut powers = [[0.0; 3]; 6];
        (powers[2][1], powers[3][1]) = (3.0, -2.0);
        let parts = parts(&Quintic(powers), 1.0, [true; 2]);
        assert_eq!(parts.len(), 2);
        for part in parts {
            assert!((part.curve.length_m() - 0.5).abs() < 1e-6);
        }
    }
}
