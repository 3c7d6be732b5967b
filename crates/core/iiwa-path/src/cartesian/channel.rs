//! Orientation and E1 along a spline: separate splines, linked to the arc length of the position.

use super::{
    knot_rates::{RateSource, Stretch, rate_sources, with_ends},
    link::link_rates,
    quintic::{Linked, Quintic, Rates},
};

/// Least chord of orientation and E1, in rad.
pub(crate) const MIN_CHORD_RAD: f64 = 3e-4;

/// Computes one channel along the segments of a spline, each as the difference from its start;
/// `None` where the rates are given.
///
/// Between free segments the channel is a spline in its own chords with a link to the arc length.
/// Next to a segment with given rates (LIN, CIRC, constant orientation) it is a quintic in the arc
/// length, because a link with the slope of that neighbour could turn back.
pub(crate) fn channel<const N: usize>(
    stretches: &[Stretch<N>],
    arcs_m: &[f64],
    carried: impl Fn(&[f64; N], &Rates<N>) -> Rates<N>,
) -> Vec<Option<Linked<N>>> {
    let piece = |index: usize| {
        let Stretch::Free { chord, step } = &stretches[index] else { return None };
        let arc_m = arcs_m[index];
        let (chord, ends) = (*chord, rate_sources(stretches, index));
        // Without neighbours, a parabola is not defined: a single SPL is a straight line.
        if ends == [RateSource::End; 2] {
            return Some(Linked::even([0.0; N], *step));
        }
        let links = [0, 1].map(|end| match ends[end] {
            RateSource::Parabola(_) => link_at(stretches, arcs_m, index + end),
            _ => Rates::even(&[chord], arc_m),
        });
        let is_given = |source: &RateSource<N>| matches!(source, RateSource::Neighbour(_));
        let (length, link) = if ends.iter().any(is_given) {
            (arc_m, None)
        } else {
            let link = Quintic::hermite([&[0.0], &[chord]], [&links[0], &links[1]], arc_m);
            (chord, Some(Quintic(link.0.map(|[w]| [w / chord]))))
        };
        let rates = [0, 1].map(|end| match ends[end] {
            RateSource::Parabola(by_chord) if link.is_some() => Some(by_chord),
            RateSource::Parabola(by_chord) => Some(by_arc(&by_chord, &links[end])),
            RateSource::Neighbour(by_arc) => Some(by_arc),
            // The same condition as at the ends of a link.
            RateSource::End if link.is_none() => Some(Rates::even(step, arc_m)),
            RateSource::End => None,
        });
        let [start, end] = with_ends(rates, length, step, &carried);
        // The curve is relative to the start of the segment, `end` to the knot at its end.
        let end = carried(step, &end);
        let curve = Quintic::hermite([&[0.0; N], step], [&start, &end], length);
        Some(Linked::new(link, curve.0.to_vec()))
    };
    (0..stretches.len()).map(piece).collect()
}

/// Rates of the link at the knot between two free segments.
fn link_at<const N: usize>(stretches: &[Stretch<N>], arcs_m: &[f64], knot: usize) -> Rates<1> {
    let sides = [knot - 1, knot];
    let chords = sides.map(|i| match &stretches[i] {
        Stretch::Free { chord, .. } => *chord,
        // Does not occur: parabolas have free segments on both sides.
        Stretch::Given(_) => MIN_CHORD_RAD,
    });
    link_rates(sides.map(|i| arcs_m[i]), chords)
}

/// Converts rates by chord length into rates by arc length.
fn by_arc<const N: usize>(by_chord: &Rates<N>, link: &Rates<1>) -> Rates<N> {
    let ([m], [c]) = (link.first, link.second);
    Rates {
        first: by_chord.first.map(|rate| rate * m),
        second: std::array::from_fn(|i| by_chord.second[i] * m * m + by_chord.first[i] * c),
    }
}
